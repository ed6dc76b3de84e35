#include "tools/scene/live/led_stroke.h"

#include <utility>

#include "lib/session/hand/hand_span.h"
#include "lib/session/step_model.h"
#include "tools/scene/live/hand_lead.h"
#include "tools/scene/live/piece_in_hand.h"

namespace supple::tools {

namespace {

/// Shifts along the axes of the grid span all.
const std::vector<HandDirection> kAxes = {{{10, 0, 0}}, {{0, 10, 0}}, {{0, 0, 10}}};

}  // namespace

/// The step that leads what was grabbed by so far, in the frame of its handle, and turns it as the
/// event says; null: where it grabbed.
Step LedStroke::stroke(const LiveEvent& model, const Vec3d& by, const LiveEvent* drag) const {
  const LiveEvent& grab = *m_hand.grab;
  Step step;
  step.place = grab.place;
  step.drags = grab.step.drags;
  PlacedHandle& handle = *step.drags.front().placed;
  handle.by = by;
  Value handle_keys = handle.keys;
  handle_keys["by"] = by;
  if (drag != nullptr && m_hand.piece) {
    m_hand.piece->add_turn(*drag, m_session, step.drags.front(), handle_keys);
  }
  step.no_relax = true;
  step.keys = {{"handles", Value::List{std::move(handle_keys)}}, {"no_relax", true}};
  take_model(model.step, step);
  step.keys.update(model.step.keys);
  step.fem->directions = grab.directions.empty() ? kAxes : grab.directions;
  step.fem->directions.insert(step.fem->directions.end(), m_further.begin(), m_further.end());
  for (const HandDirection& direction : step.fem->directions) {
    step.keys["fem"]["directions"].push_back(direction.value());
  }
  return step;
}

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
  const Geometry& geometry = m_session.geometry();
  const Step grab = on_grid(stroke(model, Vec3d(0), nullptr), geometry);
  std::vector<DragPose> directions;
  for (const HandDirection& one : grab.fem->directions) directions.push_back(one.pose(geometry));
  try {
    m_lead =
        std::make_unique<HandLead>(m_session.held_body(), grab, std::move(directions), m_ahead);
  } catch (...) {
    m_hand.grab.reset();
    throw;
  }
}

void LedStroke::lead_by(const LiveEvent& drag, const Vec3d& by, const LiveEvent& model) {
  if (!m_lead) begin(model);
  const Geometry& geometry = m_session.geometry();
  Step step = stroke(model, by, &drag);
  const Drag led = on_grid(step, geometry).drags.front();
  const DragPose target{led.by_mm, led.motion};
  const auto further = lacking_directions(target, step.fem->directions, geometry);
  if (!further.empty()) {
    const Step grab = on_grid(stroke(model, Vec3d(0), nullptr), geometry);
    for (const HandDirection& direction : further) {
      m_lead->add(m_session.held_body(), grab, direction.pose(geometry));
      m_further.push_back(direction);
    }
    step = stroke(model, by, &drag);
  }
  check_places(step, geometry);
  const double turned_deg = asked_deg(drag);
  m_hand.led = {drag.to,    drag.to, turned_deg,
                turned_deg, false,   m_session.body().elements.active_count()};
  m_step.reset();
  if (by != Vec3d(0) || turned_deg > 0) {
    m_step = {EventKind::drag, 0, 0, step, m_hand.reached, m_hand.reached + by};
    m_step->turned_deg = turned_deg;
  }
  m_lead->lead_to(target);
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
    m_lead->lead_to({Vec3d(0), {}});
  } else {
    m_lead.reset();
  }
  return true;
}

}  // namespace supple::tools
