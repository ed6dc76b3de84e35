// Measures of an operation, by which it is scored: one row of a table for each measure, found step
// by step from samples, with memory that does not grow with time.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lib/operation/operation_sample.h"
#include "lib/operation/tip_filter.h"
#include "volumes/base/fields.h"

namespace supple {

/// Categories of published studies of EyeSi.
enum class ScoreCategory { tissue, efficiency, target, instruments, microscope };
constexpr int kScoreCategories = 5;
const std::vector<std::string>& category_keys();

/// Facts of the scene that measures know beside its samples.
struct OperationSurroundings {
  Vec3d globe_centre_mm{0, 0, 0};
  double globe_radius_mm = 0;     // 0: there is none
  std::string lamp;               // instrument whose cone of light is looked at; empty: none
  double lamp_cone_degrees = 35;  // half of it
  Vec3d view{0, 0, 1};            // from the focal plane to the microscope, in the head's frame
};
Fields fields(OperationSurroundings& around);

/// Motion of a tip in one step.
struct TipMotion {
  Vec3d tip_mm{0, 0, 0};     // as the sample has it
  Vec3d steady_mm{0, 0, 0};  // without tremor, later by the delay of the filter
  Vec3d way_mm{0, 0, 0};     // of the steady tip in this step
  Vec3d tremor_mm{0, 0, 0};  // of the place that the hand asks for
};

/// One step as measures see it.
struct OperationStep {
  const OperationSample& sample;
  double dt_s;                  // since the sample before; 0 in the first one
  std::vector<TipMotion> tips;  // per instrument
  std::vector<OperationEvent> task_events;
  double task_part;  // mean progress of the tasks
  bool is_done;      // all tasks are done, and there is one
  bool holds_target;
};

/// What one rule looks at.
struct MeasureScope {
  int tool = -1;               // index; -1: all
  std::string instrument, at;  // of events; empty: any
  int lamp = -1;               // index; -1: none
  OperationSurroundings around;
};

/// What becomes of the numbers of all steps.
enum class Gather { sum, largest, least, mean, root_mean_square, last };

/// What a rule may narrow a measure to.
enum class MeasureOf { operation, tip, events, places };

using StepNumber = std::function<double(const OperationStep& step)>;

struct MeasureKind {
  const char* name;
  const char* unit;
  const char* help;
  ScoreCategory category;  // usual
  MeasureOf of;            // places: events of an instrument at an obstacle or membrane
  Gather gather;
  bool is_wanted;  // more of it is better, so that what is short of `allowed` costs points
  /// The number of each step; what it keeps between steps lies in the function.
  StepNumber (*make)(const MeasureScope& scope);
  bool needs_globe = false;
};

const std::vector<MeasureKind>& measure_kinds();
std::vector<std::string> measure_names();
/// The row of a name, which must be there.
const MeasureKind& measure_kind(const std::string& name);

/// Rows of the table by what they look at (measures.cpp joins them).
std::vector<MeasureKind> tip_measures();
std::vector<MeasureKind> event_measures();

/// Gathers one measure of one scope.
class GatheredMeasure {
 public:
  GatheredMeasure(const MeasureKind& kind, const MeasureScope& scope)
      : m_gather(kind.gather), m_number(kind.make(scope)) {}

  void take(const OperationStep& step);
  /// The number of all steps so far; 0 where there was none.
  double value() const;

 private:
  Gather m_gather;
  StepNumber m_number;
  bool m_has_begun = false;
  double m_value = 0, m_time_s = 0;
};

}  // namespace supple
