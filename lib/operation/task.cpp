#include "lib/operation/task.h"

#include <algorithm>

#include "volumes/base/error.h"

namespace supple {

namespace {

const std::vector<std::string> kTaskKinds = {"navigate", "peel", "vitrectomy"};

/// Rounding that is left to the last bit of area.
constexpr double kRounding = 1e-9;

/// Refuses keys that another kind of task has.
void require_own_keys(Table& table, ExerciseKind kind) {
  struct KeyOf {
    const char* key;
    bool is_own;
  };
  const bool is_navigate = kind == ExerciseKind::navigate;
  for (const KeyOf& one : {KeyOf{"targets", is_navigate}, KeyOf{"body", kind == ExerciseKind::peel},
                           KeyOf{"part", !is_navigate}}) {
    if (one.is_own || !table.has(one.key)) continue;
    table.fail(one.key, "a key of another kind of task",
               "keys of \"" + kTaskKinds[std::size_t(kind)] + "\"");
  }
}

}  // namespace

Fields fields(TaskSetup& setup) {
  return {
      Field("name", setup.name, "Name of the task"),
      Field("kind", setup.kind, kTaskKinds, "What is to be done").required(),
      Field("instrument", setup.instrument, "Instrument that does it, for navigate"),
      Field("body", setup.body, "Membrane to be peeled; all where none is named"),
      Field("part", setup.part, "Part to be freed or removed").range(0.001, 1),
  };
}

Fields fields(TaskTarget& target) {
  return {
      Field("at", target.centre_mm, "Centre [x, y, z]").unit("mm").required(),
      Field("radius", target.radius_mm, "Radius of the ball").unit("mm").positive(),
      Field("hold", target.hold_s, "How long the tip is to be held in it").unit("s").at_least(0),
  };
}

TaskSetup read_task(Table& table) {
  TaskSetup setup;
  setup.place = table.place();
  table.know({"targets"});
  table.read(fields(setup));
  require_own_keys(table, setup.kind);
  for (Table& row : table.tables("targets")) {
    TaskTarget target;
    row.read(fields(target));
    row.finish();
    setup.targets.push_back(target);
  }
  table.finish();
  if (setup.name.empty()) setup.name = kTaskKinds[std::size_t(setup.kind)];
  if (setup.kind != ExerciseKind::navigate) return setup;
  if (setup.targets.empty()) {
    table.fail_missing("targets", "a list of { at = [x, y, z], radius = 0.5, hold = 1.0 }");
  }
  if (setup.instrument.empty()) table.fail_missing("instrument", "the name of an instrument");
  return setup;
}

std::vector<TaskSetup> read_tasks(Table& scene) {
  std::vector<TaskSetup> tasks;
  for (Table& row : scene.tables("task")) {
    TaskSetup task = read_task(row);
    for (const TaskSetup& other : tasks) {
      if (other.name == task.name) row.fail("name", "\"" + task.name + "\" twice", "another name");
    }
    tasks.push_back(std::move(task));
  }
  return tasks;
}

Value to_value(const TaskSetup& setup) {
  TaskSetup copy = setup;
  Value value = fields_value(fields(copy));
  const bool is_navigate = setup.kind == ExerciseKind::navigate;
  if (is_navigate) value.erase("part");
  for (TaskTarget target : setup.targets) {
    value["targets"].push_back(fields_value(fields(target)));
  }
  return value;
}

int index_of_name(const std::string& name, const std::vector<std::string>& names,
                  const std::string& place, const std::string& key) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw InputError({place, key, "\"" + name + "\"",
                      names.empty() ? "nothing, since there is none" : listed(names, "or")});
  }
  return int(found - names.begin());
}

TaskWatcher::TaskWatcher(const TaskSetup& setup, const std::vector<std::string>& instruments)
    : m_setup(setup) {
  if (setup.instrument.empty()) return;
  m_instrument = index_of_name(setup.instrument, instruments, setup.place, "task.instrument");
}

void TaskWatcher::add_event(const OperationSample& sample, const char* kind,
                            const TaskTarget* target) {
  OperationEvent event;
  event.time_s = sample.time_s;
  event.kind = kind;
  event.instrument = m_setup.instrument;
  event.at = m_setup.name;
  if (target != nullptr) {
    event.place_mm = target->centre_mm;
    event.value = double(target - m_setup.targets.data()) + 1;
  }
  m_events.push_back(std::move(event));
}

double TaskWatcher::clinging_mm2(const OperationSample& sample) const {
  if (m_setup.body.empty()) return sample.clinging_mm2;
  std::vector<std::string> names;
  for (const MembraneSample& membrane : sample.membranes) names.push_back(membrane.body);
  const int index = index_of_name(m_setup.body, names, m_setup.place, "task.body");
  return sample.membranes[std::size_t(index)].clinging_mm2;
}

void TaskWatcher::begin(const OperationSample& sample) {
  add_event(sample, "task_begun", nullptr);
  if (m_setup.kind == ExerciseKind::navigate) return;
  const bool is_peel = m_setup.kind == ExerciseKind::peel;
  m_whole = is_peel ? clinging_mm2(sample) : sample.vitreous_left;
  require(m_whole > 0, "task.kind", m_whole,
          is_peel ? "a membrane that clings, to be peeled" : "vitreous to be removed",
          m_setup.place);
}

/// Holds the active target or loses it; the time within it counts from the step in which the tip
/// came in.
void TaskWatcher::watch_target(const OperationSample& sample, double dt_s) {
  const TaskTarget& target = m_setup.targets[m_active];
  const Vec3d tip = m_tip.take(sample.instruments.at(std::size_t(m_instrument)).pose.tip_mm, dt_s);
  const bool is_inside = (tip - target.centre_mm).length() <= target.radius_mm;
  if (is_inside && m_is_inside) m_held_s += dt_s;
  if (!is_inside) {
    if (m_is_inside) add_event(sample, "target_lost", &target);
    m_held_s = 0;
  }
  m_is_inside = is_inside;
  if (is_inside && m_held_s >= target.hold_s - kRounding) {
    add_event(sample, "target_reached", &target);
    ++m_active;
    m_held_s = 0;
    m_is_inside = false;
  }
}

std::vector<OperationEvent> TaskWatcher::take(const OperationSample& sample) {
  m_events.clear();
  if (!m_before_s) begin(sample);
  const double dt_s = sample.time_s - m_before_s.value_or(sample.time_s);
  m_before_s = sample.time_s;
  if (is_done()) return {};

  if (m_setup.kind == ExerciseKind::navigate) {
    watch_target(sample, dt_s);
    const double count = double(m_setup.targets.size());
    const double held = m_active < m_setup.targets.size() ? targets()[m_active].held_part : 0;
    m_progress = (double(m_active) + held) / count;
    if (m_active < m_setup.targets.size()) return m_events;
  } else {
    const double left =
        m_setup.kind == ExerciseKind::peel ? clinging_mm2(sample) : sample.vitreous_left;
    m_progress = std::clamp((m_whole - left) / (m_setup.part * m_whole), 0.0, 1.0);
    if (m_progress < 1 - kRounding) return m_events;
  }
  m_progress = 1;
  m_done_s = sample.time_s;
  add_event(sample, "task_done", nullptr);
  return m_events;
}

std::vector<TargetProgress> TaskWatcher::targets() const {
  std::vector<TargetProgress> all(m_setup.targets.size());
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (n < m_active) all[n] = {TargetState::done, 1};
  }
  if (m_active >= all.size()) return all;
  const double hold_s = m_setup.targets[m_active].hold_s;
  all[m_active] = {m_is_inside ? TargetState::held : TargetState::active,
                   hold_s > 0 ? std::min(1.0, m_held_s / hold_s) : 0};
  return all;
}

}  // namespace supple
