// Tasks of an operation, watched from its samples alone: balls in which a tip is held (thesis
// section 6.1.2), a membrane that is freed, vitreous that is removed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/operation/operation_sample.h"
#include "lib/operation/tip_filter.h"
#include "volumes/base/fields.h"
#include "volumes/base/table.h"
#include "volumes/base/value.h"

namespace supple {

enum class ExerciseKind { navigate, peel, vitrectomy };

/// A ball in which a tip is to be held.
struct TaskTarget {
  Vec3d centre_mm{0, 0, 0};
  double radius_mm = 0.5;
  double hold_s = 1;
};

struct TaskSetup {
  std::string name;
  ExerciseKind kind = ExerciseKind::navigate;
  std::string instrument;           // that does it
  std::vector<TaskTarget> targets;  // of navigate
  std::string body;                 // of peel; empty: all membranes
  double part = 0.9;                // of peel and vitrectomy: to be freed or removed
  std::string place;                // file and line, for errors
};
/// Keys of a row of [[task]], but for `targets`.
Fields fields(TaskSetup& setup);
/// Keys of a row of `targets`.
Fields fields(TaskTarget& target);
/// Throws InputError: a navigate task without targets or instrument, keys of another kind.
TaskSetup read_task(Table& table);
/// Rows of [[task]]; those without a name are called by their kind. Throws InputError for a name
/// that comes twice.
std::vector<TaskSetup> read_tasks(Table& scene);
/// The table from which read_task() reads the same.
Value to_value(const TaskSetup& setup);

/// How a picture is to show a target.
enum class TargetState { waiting, active, held, done };
struct TargetProgress {
  TargetState state = TargetState::waiting;
  double held_part = 0;  // of the time for which it is to be held
};

/// Index of a name. Throws InputError at `place` where it is none of them.
int index_of_name(const std::string& name, const std::vector<std::string>& names,
                  const std::string& place, const std::string& key);

class TaskWatcher {
 public:
  /// Throws InputError for an instrument that is none of the operation's.
  TaskWatcher(const TaskSetup& setup, const std::vector<std::string>& instruments);

  /// Returns the events of this step: task_begun in the first one, target_reached, target_lost,
  /// task_done. A tip counts by its steady place (tip_filter.h), so that tremor loses no target.
  /// Throws InputError for a membrane that is not in the sample or clings nowhere.
  std::vector<OperationEvent> take(const OperationSample& sample);

  const TaskSetup& setup() const { return m_setup; }
  double progress() const { return m_progress; }  // 0 to 1
  bool is_done() const { return m_done_s.has_value(); }
  std::optional<double> done_s() const { return m_done_s; }
  bool holds_target() const { return !is_done() && m_is_inside; }
  std::vector<TargetProgress> targets() const;

 private:
  void begin(const OperationSample& sample);
  void watch_target(const OperationSample& sample, double dt_s);
  void add_event(const OperationSample& sample, const char* kind, const TaskTarget* target);
  double clinging_mm2(const OperationSample& sample) const;

  TaskSetup m_setup;
  int m_instrument = -1;
  std::optional<double> m_before_s, m_done_s;
  double m_progress = 0;
  double m_whole = 0;  // at the start: mm² that clings, part of vitreous
  SteadyTip m_tip;
  std::size_t m_active = 0;
  bool m_is_inside = false;
  double m_held_s = 0;
  std::vector<OperationEvent> m_events;
};

}  // namespace supple
