#include "tools/scene/live/live_session.h"

#include <algorithm>
#include <filesystem>

#include "lib/session/step_model.h"
#include "tools/scene/live/held_parts.h"
#include "tools/scene/live/led_stroke.h"
#include "tools/scene/live/live_view.h"
#include "tools/scene/live/model_price.h"
#include "tools/scene/live/piece_in_hand.h"
#include "tools/scene/plan/memory_need.h"

namespace supple::tools {

namespace {

/// Returns the keys of a step that relaxes, as in a scene, not as records name them.
Value relax_keys(RelaxParams params) {
  Value keys;
  for (const Field& field : fields(params)) {
    keys["relax"][field.name()] = field.value();
  }
  return keys;
}

void require_one_thing(const LiveEvent& event) {
  const bool is_cut = event.cut > 0;
  const char* const field = event.handle > 0 ? "handle" : event.anchor > 0 ? "anchor" : "cut";
  const int things = int(event.all) + int(event.handle > 0) + int(event.anchor > 0) + int(is_cut);
  if (things <= 1 && !(is_cut && event.restore)) return;
  throw InputError(
      {event.place, field, "more than one thing to let go of", "handle, anchor, cut or all"});
}

bool has_anchors(const State& state) {
  return !state.anchors.empty() || !state.anchor_labels.empty() || !state.anchor_selections.empty();
}

/// A hand that holds something is one page's; what no page holds is anybody's to go on with.
void require_own_grab(std::optional<LiveEvent>& grab, const LiveEvent& event) {
  const bool is_of_hand = event.kind == EventKind::grab || event.kind == EventKind::push ||
                          event.kind == EventKind::drag || event.kind == EventKind::release;
  if (!grab || !is_of_hand || event.page == 0) return;
  if (grab->page == 0) grab->page = event.page;
  if (grab->page == event.page) return;
  throw InputError({event.place, name_of(event.kind), "a handle that another page holds",
                    "it when that page has let go"});
}

/// The events of a journal; of a scene its steps, each as one event.
std::vector<LiveEvent> events_of(const Scene& scene, Table root) {
  std::vector<LiveEvent> events;
  for (Table& table : root.tables("event")) events.push_back(read_event(table, scene.label_names));
  if (!events.empty() && !scene.steps.empty()) {
    throw InputError({scene.steps.front().place, "step", "a step beside events",
                      "events of a journal, or steps of a scene"});
  }
  for (const Step& step : scene.steps) {
    LiveEvent& event = events.emplace_back();
    event.place = step.place;
    event.step = step;
  }
  return events;
}

}  // namespace

LiveSession::LiveSession(const Table& root, Progress* progress)
    : m_scene(std::make_unique<const Scene>(read_scene(root))) {
  for (const std::string& line : m_scene->warnings) warn(progress, line);
  if (!m_scene->warp_path.empty() || !m_scene->path.empty() || m_scene->film) {
    throw InputError({m_scene->file, "", "a warp, path or film", "a body that events move"});
  }
  m_journal = std::make_unique<LiveJournal>(root, *m_scene);
  m_view = std::make_unique<LiveView>(*m_scene, root, progress);
  m_events = events_of(*m_scene, root);
  const SessionOptions options{m_scene->material, m_scene->labels_path, m_scene->read, true};
  require_memory_to_open(*m_scene, progress);
  m_session = std::make_unique<Session>(m_scene->volume_path, options, progress);
  m_led = std::make_unique<LedStroke>(*m_session, m_history, m_hand);
  add_bodies(m_scene->bodies, *m_session);
  if (m_session->geometry().dims().z == 1) {
    throw InputError({m_scene->volume_path, "", "one slice", "a volume of several slices"});
  }
  m_is_state_anchored = is_state_file(m_scene->volume_path) && has_anchors(m_session->state());
}

LiveSession::~LiveSession() = default;

void LiveSession::carry_out(const LiveEvent& event, Progress* progress) {
  try {
    act_on(event, progress);
  } catch (const InputError& error) {
    Problem problem = error.problem();
    const bool is_of_view_text = problem.file.rfind(event.place + ":", 0) == 0;
    if (problem.file.empty() || is_of_view_text) problem.file = event.place;
    throw InputError(problem);
  }
}

void LiveSession::act_on(const LiveEvent& event, Progress* progress) {
  require_own_grab(m_hand.grab, event);
  if (event.is_of_view()) {
    change_view(event);
    return;
  }
  m_pending = 0;
  m_is_unsettled = false;
  const bool is_of_stroke = event.kind == EventKind::drag || event.kind == EventKind::undo ||
                            (event.kind == EventKind::release && event.cut == 0);
  if (!is_of_stroke) {
    m_led->finish(progress);
    m_led->drop_lead();
  }
  switch (event.kind) {
    case EventKind::grab:
    case EventKind::push: {
      Step asked = event.step;
      asked.drags.front().placed->by = Vec3d(0);
      check_places(asked, m_session->geometry());
      m_session->check(asked);
      if (is_under_hand() && (event.kind == EventKind::push || event.joint_mm > 0)) {
        const bool pushes = event.kind == EventKind::push;
        throw InputError({event.place, pushes ? "push" : "joint",
                          pushes ? "a handle that only pushes" : "a joint around a piece",
                          "a grab without it: finite elements are under the hand"});
      }
      m_hand = {event, Vec3d(0), {}, PieceInHand::of(asked, *m_session)};
      m_history.hand_stroke = ++m_history.stroke;
      if (is_under_hand()) m_led->begin(*m_model);
      break;
    }
    case EventKind::drag:
      drag(event, progress);
      break;
    case EventKind::release:
      require_one_thing(event);
      if (event.cut == 0) return release(event, progress);
      take_out_cut(event, progress);
      break;
    case EventKind::model:
      m_model.reset();
      if (has_own_model(event.step)) m_model = event;
      if (const auto price = price_of(event, *m_session)) note(progress, price->text);
      break;
    case EventKind::relax:
      return relax(event, event.step.relax->passes, progress);
    case EventKind::limits:
      m_limits = event.limits;
      break;
    case EventKind::undo:
      undo(event);
      break;
    case EventKind::redo:
      redo(event, progress);
      break;
    default:
      run(event.kind, event.step, progress);
  }
  m_journal->add(event);
  if (!m_hand.grab) m_led->make_solid(is_under_hand() ? &*m_model : nullptr);
}

/// Drags from where the handle has got to, so that one that an anchor stopped follows at once when
/// it is led back.
void LiveSession::drag(const LiveEvent& event, Progress* progress) {
  if (!m_hand.grab) {
    throw InputError({event.place, "drag", "nothing that is grabbed", "grab or push before it"});
  }
  if (!m_hand.piece && event.turn != Vec3d(0)) {
    throw InputError({event.place, "turn", "a handle of no rigid piece", "rigid_at in the grab"});
  }
  const Vec3d by = event.to - m_hand.reached;
  if (is_under_hand()) return m_led->lead_by(event, by, *m_model);
  const bool begins = m_history.done.empty() || m_history.done.back().kind != EventKind::drag ||
                      m_history.done.back().stroke != m_history.hand_stroke;
  Step step;
  step.place = event.place;
  step.drags = m_hand.grab->step.drags;
  Drag& handle = step.drags.front();
  handle.placed->by = by;
  Value handle_keys = handle.placed->keys;
  handle_keys["by"] = by;
  if (handle.pushes) handle_keys["push"] = handle.placed->keys["push"] = true;
  const bool turns = m_hand.piece && m_hand.piece->add_turn(event, *m_session, handle, handle_keys);
  if (by == Vec3d(0) && !turns) return;
  step.no_relax = true;
  step.keys = {{"handles", Value::List{std::move(handle_keys)}}, {"no_relax", true}};
  const double joint_mm = m_hand.grab->joint_mm;
  if (joint_mm > 0 && begins && m_hand.piece)
    m_hand.piece->add_joint(joint_mm, *m_session, handle, step);
  const bool is_by_model = m_model && !model().waits_for_hands;
  step.shift_pieces = !m_session->body().rigid.empty() && !is_by_model;
  if (step.shift_pieces) step.keys["shift_pieces"] = true;
  if (is_by_model) {
    take_model(m_model->step, step);
    step.keys.update(m_model->step.keys);
  } else if (m_limits != Limits::box) {
    step.limits = m_limits;
    step.keys["limits"] = m_limits == Limits::ball ? "ball" : "tighten";
  }
  const Vec3d before = m_hand.reached;
  run(event.kind, step, progress);
  const StepRecord& record = m_session->records().back();
  m_hand.reached = before + way_done(record, by);
  const std::int64_t moved = m_hand.led ? m_hand.led->moved : 0;
  const double turned_deg = m_hand.piece ? m_hand.piece->turned_deg(*m_session) : 0;
  m_hand.led = {event.to,
                m_hand.reached,
                asked_deg(event),
                turned_deg,
                record.contact.parts < kContactParts,
                std::max(moved, record.report.moved)};
  m_history.done.back().reached_before = before;
  m_history.done.back().reached = m_hand.reached;
  m_history.done.back().turned_deg = turned_deg;
}

/// Lets go; then finite elements take over, or pieces that were dragged along turn and tissue
/// relaxes where the material asks for it. All are recorded as events of their own.
void LiveSession::release(const LiveEvent& event, Progress* progress) {
  LiveEvent carried_out = event;
  const auto is_last_a_drag = [&] {
    return m_hand.grab && !m_history.done.empty() &&
           m_history.done.back().stroke == m_history.hand_stroke;
  };
  const bool lets_go = event.all || event.handle > 0 || event.anchor > 0;
  if (event.restore && m_hand.grab) m_led->take_back();
  if (lets_go) m_led->finish(progress);
  if (m_led->moves()) {
    m_led->close();
  } else {
    m_led->drop_lead();
  }
  const bool was_dragged = is_last_a_drag() && !is_under_hand();
  while (event.restore && is_last_a_drag() && take_back()) {
  }
  const bool is_for_fem = was_dragged && model().waits_for_hands;
  const bool is_unsettled =
      !event.restore && !is_under_hand() && (is_for_fem || m_session->has_shifted_pieces());
  if (event.all) {
    if (is_unsettled) settle_drags(progress);
    Step step;
    step.place = event.place;
    step.release = true;
    step.keys = {{"release", true}};
    run(event.kind, step, progress);
  }
  if (event.handle > 0 || event.anchor > 0) {
    const Step step = step_without(event, held());
    if (is_unsettled) settle_drags(progress);
    run(event.kind, step, progress);
  }
  m_hand.grab.reset();
  const bool relaxes = was_dragged && !event.restore && !lets_go && !event.no_relax &&
                       m_session->material().relaxes && !m_model && m_limits != Limits::ball;
  m_is_unsettled = is_unsettled && !lets_go && !event.no_relax;
  carried_out.no_relax = event.no_relax || relaxes || m_is_unsettled;
  m_journal->add(carried_out);
  if (!relaxes) return;
  LiveEvent relaxation;
  relaxation.kind = EventKind::relax;
  relaxation.place = event.place;
  relaxation.at_ms = event.at_ms;
  relaxation.step.relax = tissue_relaxation(m_session->material().relaxes_by_poisson);
  relaxation.step.keys = relax_keys(*relaxation.step.relax);
  m_relaxation = relaxation;
  m_pending = relaxation.step.relax->passes;
}

void LiveSession::run(EventKind kind, const Step& step, Progress* progress) {
  check_places(step, m_session->geometry());
  m_session->step(step, progress);
  m_history.undone.clear();
  m_history.undone_looks.clear();
  m_history.done.push_back({kind, m_history.stroke_of(kind, step), ++m_history.order, step,
                            m_hand.reached, m_hand.reached});
}

/// Handles are held where the drags left them.
void LiveSession::settle_drags(Progress* progress) {
  LiveEvent event;
  event.kind = EventKind::step;
  if (model().waits_for_hands) {
    take_model(m_model->step, event.step);
    event.step.keys = m_model->step.keys;
  } else {
    event.step.turn_pieces = true;
    event.step.keys = {{"turn_pieces", true}};
  }
  run(event.kind, event.step, progress);
  m_is_unsettled = false;
  m_journal->add(event);
}

void LiveSession::relax(const LiveEvent& event, int passes, Progress* progress) {
  LiveEvent slice = event;
  slice.step.relax->passes = std::min(passes, kSlicePasses);
  slice.step.keys["relax"]["passes"] = slice.step.relax->passes;
  Step step;
  step.place = event.place;
  step.relax = slice.step.relax;
  step.keys = relax_keys(*step.relax);
  run(event.kind, step, progress);
  const RelaxReport& done = m_session->records().back().relaxed;
  m_pending = done.end == RelaxEnd::passes ? passes - slice.step.relax->passes : 0;
  m_journal->add(slice);
  m_relaxation = event;
  double& budget = m_relaxation->step.relax->budget_million;
  if (budget <= 0) return;
  budget -= done.looked_at_million;
  m_relaxation->step.keys = slice.step.keys;
  m_relaxation->step.keys["relax"]["budget"] = budget;
}

bool LiveSession::has_more() const {
  return m_is_unsettled || m_pending > 0 || m_led->is_to_do();
}

void LiveSession::go_on(Progress* progress) {
  if (m_led->is_to_do()) return m_led->finish(progress);
  if (m_is_unsettled) return settle_drags(progress);
  if (m_pending > 0) relax(*m_relaxation, m_pending, progress);
}

/// A stroke that has ended stands in the journal: it is taken back there, too.
void LiveSession::stop() {
  m_pending = 0;
  m_is_unsettled = false;
  if (!m_led->is_to_do()) return;
  take_back();
  LiveEvent undo;
  undo.kind = EventKind::undo;
  m_journal->add(undo);
}

const SceneView& LiveSession::view() const {
  return m_view->shown();
}

bool LiveSession::begin_with_look(const Value& look) {
  for (const auto* looks : {&m_history.looks, &m_history.undone_looks}) {
    for (const DoneLook& done : *looks) {
      if (done.kind == EventKind::look) return false;
    }
  }
  return m_view->begin_with_look(look);
}

void LiveSession::record_with(Recorder recorder) {
  m_journal->record_with(std::move(recorder));
}

HeldParts LiveSession::held() const {
  return held_parts(m_history.done, m_is_state_anchored);
}

HandLead* LiveSession::lead() const {
  return m_led->lead();
}

Value LiveSession::journal() const {
  return m_journal->written(*m_view);
}

Value LiveSession::batch_scene() const {
  return m_journal->batch_scene(m_history.done, *m_view, m_scene->output.refers);
}

const StepModel& LiveSession::model() const {
  return m_model ? model_of(m_model->step) : step_models().front();
}

}  // namespace supple::tools
