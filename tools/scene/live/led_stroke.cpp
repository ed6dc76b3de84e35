// The part of a live session that has finite elements under the hand: a stroke is one step, whose
// responses are found while the hand leads.
#include <utility>

#include "lib/session/step_model.h"
#include "tools/scene/live/hand_lead.h"
#include "tools/scene/live/live_session.h"

namespace supple::tools {

namespace {

/// Shifts along the axes of the grid span all.
const std::vector<Vec3d> kAxes_mm = {{10, 0, 0}, {0, 10, 0}, {0, 0, 10}};

/// The step that leads what was grabbed there.
Step stroke_of(const LiveEvent& grab, const LiveEvent& model, const Vec3d& by) {
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
  for (const Vec3d& direction : step.fem->directions) {
    step.keys["fem"]["directions"].push_back(direction);
  }
  return step;
}

}  // namespace

void LiveSession::begin_lead() {
  m_lead.reset();
  if (!is_under_hand()) return;
  const Step grab = on_grid(stroke_of(*m_hand.grab, *m_model, Vec3d(0)), m_session->geometry());
  try {
    m_lead = std::make_unique<HandLead>(m_session->held_body(), grab, grab.fem->directions);
  } catch (...) {
    m_hand.grab.reset();
    throw;
  }
}

/// The hand's target stands whatever ChainMail makes of it, which is seen until there is a level.
void LiveSession::lead_by(const LiveEvent& event, const Vec3d& by) {
  if (!m_lead) begin_lead();
  Step step = stroke_of(*m_hand.grab, *m_model, by);
  check_places(step, m_session->geometry());
  m_hand.led = {event.to, event.to, false, m_session->body().elements.active_count()};
  m_stroke.reset();
  if (by != Vec3d(0)) {
    m_stroke = {EventKind::drag, 0, 0, step, m_hand.reached, m_hand.reached + by};
  }
  m_lead->lead_to(by);
  if (!m_lead->has_level()) {
    Step follower;
    follower.drags = step.drags;
    follower.no_relax = true;
    follower.shift_pieces = !m_session->body().rigid.empty();
    try {
      m_session->step(follower);
      m_lead->show_before(m_session->body().q);
      m_session->undo();
    } catch (const InputError&) {  // ChainMail cannot follow: a level will
    }
  }
}

/// The stroke takes its place among the steps, which it has whenever it is done.
void LiveSession::close_stroke() {
  if (!m_stroke || m_stroke->order > 0) return;
  m_history.undone.clear();
  m_history.undone_looks.clear();
  m_stroke->stroke = m_history.stroke_of(m_stroke->kind, m_stroke->step);
  m_stroke->order = ++m_history.order;
}

/// Does the step of the stroke, once its responses are found. Where that cannot be, the stroke is
/// dropped; Cancelled leaves it to be done.
void LiveSession::end_stroke(Progress* progress) {
  if (!m_stroke) return;
  close_stroke();
  try {
    Step step = m_stroke->step;
    if (m_lead) step.fem->responses = m_lead->found(progress);
    m_session->step(step, progress);
  } catch (const Cancelled&) {
    throw;
  } catch (...) {
    m_stroke.reset();
    m_lead.reset();
    throw;
  }
  m_hand.reached = m_stroke->reached;
  m_history.done.push_back(*std::exchange(m_stroke, {}));
  m_lead.reset();
}

}  // namespace supple::tools
