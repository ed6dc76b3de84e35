// Tasks and scores of an operation, from its samples alone, so that a log replays to the same score.
// Categories as in published studies of EyeSi; 100 points each, rules take points off.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/operation/operation_sample.h"
#include "volumes/base/fields.h"
#include "volumes/base/value.h"

namespace supple {

enum class ScoreCategory { tissue, efficiency, target, instruments, microscope };

enum class TaskKind { navigate, peel, vitrectomy };

/// A ball in which a tip is to be held.
struct TaskTarget {
  Vec3d centre_mm;
  double radius_mm = 0.5;
  double hold_s = 1;
};

struct TaskSetup {
  std::string name;
  TaskKind kind = TaskKind::navigate;
  std::string instrument;           // that does it
  std::vector<TaskTarget> targets;  // of navigate
  std::string body;                 // of peel
  double part = 0.9;                // of peel and vitrectomy: to be freed or removed
};

/// Takes points off: per unit of what it measures beyond `allowed`, at most `most`.
struct ScoreRule {
  ScoreCategory category = ScoreCategory::tissue;
  std::string measure;     // "touch_force", "touches", "bleeding", "path", "time", "jitter", ...
  std::string instrument;  // empty: all
  std::string at;          // obstacle; empty: all
  double allowed = 0;
  double points_per_unit = 1;
  double most = 100;
};

}  // namespace supple
