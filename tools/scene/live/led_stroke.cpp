#include "tools/scene/live/led_stroke.h"

#include <cmath>
#include <utility>

#include "lib/session/step_model.h"
#include "tools/scene/live/hand_lead.h"

namespace supple::tools {

namespace {

/// Shifts along the axes of the grid span all.
const std::vector<Vec3d> kAxes_mm = {{10, 0, 0}, {0, 10, 0}, {0, 0, 10}};

/// What of a way no direction has is a direction of its own from this part of the way on.
constexpr double kOwnPart = 1e-6;
constexpr double kDirection_mm = 10;

/// The direction that a way lacks among these, across them all, in whole thousandths of a mm.
std::optional<Vec3d> lacking(const Vec3d& way, const std::vector<Vec3d>& directions) {
  std::vector<Vec3d> across;
  const auto rest_of = [&](Vec3d rest) {
    for (int twice = 0; twice < 2; ++twice) {
      for (const Vec3d& axis : across) rest -= axis * axis.dot(rest);
    }
    return rest;
  };
  for (const Vec3d& direction : directions) {
    const Vec3d rest = rest_of(direction);
    if (rest.length() > kOwnPart * direction.length()) across.push_back(rest / rest.length());
  }
  const Vec3d rest = rest_of(way);
  if (!(rest.length() > kOwnPart * way.length())) return std::nullopt;
  Vec3d direction = rest * (kDirection_mm / rest.length());
  for (int a = 0; a < 3; ++a) direction[a] = std::round(direction[a] * 1000) / 1000;
  return direction;
}

/// The step that leads what was grabbed there.
Step stroke_of(const LiveEvent& grab, const std::vector<Vec3d>& further, const LiveEvent& model,
               const Vec3d& by) {
  Step step;
  step.place = grab.place;
  step.drags = grab.step.drags;
  PlacedHandle& handle = *step.drags.front().placed;
  handle.by = by;
  Value handle_keys = handle.keys;
  handle_keys["by"] = by;
  step.no_relax = true;
  step.keys = {{"handles", Value::List{std::move(handle_keys)}}, {"no_relax", true}};
  take_model(model.step, step);
  step.keys.update(model.step.keys);
  step.fem->directions = grab.directions.empty() ? kAxes_mm : grab.directions;
  step.fem->directions.insert(step.fem->directions.end(), further.begin(), further.end());
  for (const Vec3d& direction : step.fem->directions) {
    step.keys["fem"]["directions"].push_back(direction);
  }
  return step;
}

}  // namespace

LedStroke::LedStroke(Session& session, LiveHistory& history, LiveHand& hand)
    : m_session(session), m_history(history), m_hand(hand) {}

LedStroke::~LedStroke() = default;

void LedStroke::drop_lead() {
  m_lead.reset();
}

void LedStroke::make_solid(const LiveEvent* model) {
  if (model == nullptr) return m_ahead.reset();
  Step step;
  take_model(model->step, step);
  SessionBody& body = m_session.held_body();
  if (m_ahead && m_ahead->is_of(body, *step.fem)) return;
  m_ahead.reset();
  // Solids of joined voxels change with what is held.
  if (step.fem->params.elements.touching == Touching::joined) return;
  m_ahead = std::make_shared<AheadThread>(body, *step.fem);
}

void LedStroke::begin(const LiveEvent& model) {
  m_lead.reset();
  m_further.clear();
  const Step grab = on_grid(stroke_of(*m_hand.grab, {}, model, Vec3d(0)), m_session.geometry());
  try {
    m_lead = std::make_unique<HandLead>(m_session.held_body(), grab, grab.fem->directions, m_ahead);
  } catch (...) {
    m_hand.grab.reset();
    throw;
  }
}

void LedStroke::lead_by(const LiveEvent& drag, const Vec3d& by, const LiveEvent& model) {
  if (!m_lead) begin(model);
  Step step = stroke_of(*m_hand.grab, m_further, model, by);
  if (const auto direction = lacking(by, step.fem->directions)) {
    m_further.push_back(*direction);
    const Step grab =
        on_grid(stroke_of(*m_hand.grab, m_further, model, Vec3d(0)), m_session.geometry());
    m_lead->add(m_session.held_body(), grab, grab.fem->directions.back());
    step = stroke_of(*m_hand.grab, m_further, model, by);
  }
  check_places(step, m_session.geometry());
  m_hand.led = {drag.to, drag.to, 0, 0, false, m_session.body().elements.active_count()};
  m_step.reset();
  if (by != Vec3d(0)) {
    m_step = {EventKind::drag, 0, 0, step, m_hand.reached, m_hand.reached + by};
  }
  m_lead->lead_to(by);
  if (m_lead->has_level()) return;
  Step follower;
  follower.drags = step.drags;
  follower.no_relax = true;
  follower.shift_pieces = !m_session.body().rigid.empty();
  try {
    m_session.step(follower);
    m_lead->show_before(m_session.body().q);
    m_session.undo();
  } catch (const InputError&) {  // ChainMail cannot follow: a level will
  }
}

void LedStroke::close() {
  if (!m_step || m_step->order > 0) return;
  m_history.undone.clear();
  m_history.undone_looks.clear();
  m_step->stroke = m_history.stroke_of(m_step->kind, m_step->step);
  m_step->order = ++m_history.order;
}

void LedStroke::finish(Progress* progress) {
  if (!m_step) return;
  close();
  try {
    Step step = m_step->step;
    if (m_lead) step.fem->responses = m_lead->found(progress);
    m_session.step(step, progress);
  } catch (const Cancelled&) {
    throw;
  } catch (...) {
    m_step.reset();
    m_lead.reset();
    throw;
  }
  m_hand.reached = m_step->reached;
  m_history.done.push_back(*std::exchange(m_step, {}));
  m_lead.reset();
}

bool LedStroke::take_back() {
  if (!m_step) return false;
  close();
  m_hand.reached = m_step->reached_before;
  m_history.undone.push_back(*std::exchange(m_step, {}));
  if (m_hand.grab && m_lead) {
    m_lead->lead_to(Vec3d(0));
  } else {
    m_lead.reset();
  }
  return true;
}

}  // namespace supple::tools
