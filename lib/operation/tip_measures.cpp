#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/operation/eye.h"
#include "lib/operation/measure.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

/// A steady tip below this speed stands.
constexpr double kStands_mm_s = 0.5;
/// Nearer to the globe than this is near.
constexpr double kNear_mm = 0.5;
/// Jaws are closed below the first part of the widest opening so far, and open above the second.
constexpr double kClosedPart = 0.3, kOpenPart = 0.6;
constexpr double kLeastOpening_degrees = 1;

const TipMotion& tip_of(const MeasureScope& scope, const OperationStep& step) {
  return step.tips[std::size_t(scope.tool)];
}

double speed_mm_s(const MeasureScope& scope, const OperationStep& step) {
  return step.dt_s > 0 ? tip_of(scope, step).way_mm.length() / step.dt_s : 0;
}

/// Distance between the tip and the globe, from inside.
double clearance_mm(const MeasureScope& scope, const OperationStep& step) {
  const Vec3d from = tip_of(scope, step).tip_mm - scope.around.globe_centre_mm;
  return scope.around.globe_radius_mm - from.length();
}

/// Distance between the tip and the focal plane, in the head's frame.
double out_of_focus_mm(const MeasureScope& scope, const OperationStep& step) {
  const EyeTurn turn{step.sample.turn_degrees * kRadiansPerDegree};
  const Vec3d from = turn.to_head(tip_of(scope, step).tip_mm) - step.sample.focus_mm;
  return std::abs(from.dot(scope.around.view.normalized()));
}

bool is_in_light(const MeasureScope& scope, const OperationStep& step) {
  if (scope.lamp < 0 || scope.lamp == scope.tool) return true;
  const InstrumentPose& lamp = step.sample.instruments[std::size_t(scope.lamp)].pose;
  const Vec3d from = tip_of(scope, step).tip_mm - lamp.tip_mm;
  const double along = -from.dot(lamp.axis);
  const double cone = scope.around.lamp_cone_degrees * kRadiansPerDegree;
  return along >= from.length() * std::cos(cone);
}

/// A measure that keeps nothing between steps.
template <auto number>
StepNumber each_step(const MeasureScope& scope) {
  return [scope](const OperationStep& step) { return double(number(scope, step)); };
}

/// Seconds in which something holds.
template <auto holds>
StepNumber seconds_while(const MeasureScope& scope) {
  return [scope](const OperationStep& step) { return holds(scope, step) ? step.dt_s : 0; };
}

double way_mm(const MeasureScope& scope, const OperationStep& step) {
  return tip_of(scope, step).way_mm.length();
}

/// Its root mean square is that of one coordinate.
double tremor_mm(const MeasureScope& scope, const OperationStep& step) {
  return tip_of(scope, step).tremor_mm.length() / std::sqrt(3.0);
}

double force_n(const MeasureScope& scope, const OperationStep& step) {
  return step.sample.instruments[std::size_t(scope.tool)].force_n;
}

bool is_idle(const MeasureScope& scope, const OperationStep& step) {
  return !step.is_done && !step.holds_target && speed_mm_s(scope, step) < kStands_mm_s;
}

bool is_near(const MeasureScope& scope, const OperationStep& step) {
  return clearance_mm(scope, step) < kNear_mm;
}

bool is_unlit(const MeasureScope& scope, const OperationStep& step) {
  return !is_in_light(scope, step);
}

/// At each target that is reached: the way since the last one, beyond the straight line.
StepNumber detour(const MeasureScope& scope) {
  return
      [scope, has_begun = false, corner = Vec3d(0), way = 0.0](const OperationStep& step) mutable {
        const TipMotion& tip = tip_of(scope, step);
        if (!std::exchange(has_begun, true)) corner = tip.steady_mm;
        way += tip.way_mm.length();
        double beyond = 0;
        for (const OperationEvent& event : step.task_events) {
          if (event.kind != "target_reached" || event.instrument != scope.instrument) continue;
          beyond += std::max(0.0, way - (tip.steady_mm - corner).length());
          corner = tip.steady_mm;
          way = 0;
        }
        return beyond;
      };
}

/// Counts jaws that closed, took hold of nothing and open again.
StepNumber empty_grips(const MeasureScope& scope) {
  return [scope, widest = kLeastOpening_degrees, is_closed = false,
          has_gripped = false](const OperationStep& step) mutable {
    const double opening = step.sample.instruments[std::size_t(scope.tool)].pose.opening_degrees;
    widest = std::max(widest, opening);
    for (const OperationEvent& event : step.sample.events) {
      has_gripped |= event.kind == "gripped" && event.instrument == scope.instrument;
    }
    if (opening > kOpenPart * widest) {
      const bool was_empty = is_closed && !has_gripped;
      is_closed = has_gripped = false;
      return was_empty ? 1.0 : 0.0;
    }
    // The first step may have closed jaws: only those that were wide close on something.
    is_closed |= opening < kClosedPart * widest && widest > kLeastOpening_degrees;
    return 0.0;
  };
}

}  // namespace

std::vector<MeasureKind> tip_measures() {
  using Category = ScoreCategory;
  const auto of = MeasureOf::tip;
  return {
      {"path_mm", "mm", "Way of the steady tip", Category::efficiency, of, Gather::sum, false,
       each_step<way_mm>},
      {"detour_mm", "mm", "Way of the steady tip beyond straight lines from target to target",
       Category::efficiency, of, Gather::sum, false, detour},
      {"idle_s", "s", "Time in which the tip stands and holds no target", Category::efficiency, of,
       Gather::sum, false, seconds_while<is_idle>},
      {"tremor_mm", "mm", "Motion of the hand above 4 Hz, root mean square of a coordinate",
       Category::instruments, of, Gather::root_mean_square, false, each_step<tremor_mm>},
      {"speed_mm_s", "mm/s", "Largest speed of the steady tip", Category::instruments, of,
       Gather::largest, false, each_step<speed_mm_s>},
      {"force_n", "N", "Largest force of all touches at once", Category::tissue, of,
       Gather::largest, false, each_step<force_n>},
      {"empty_grips", "", "Times that jaws closed on nothing", Category::instruments, of,
       Gather::sum, false, empty_grips},
      {"clearance_mm", "mm", "Least distance between tip and globe", Category::tissue, of,
       Gather::least, true, each_step<clearance_mm>, true},
      {"near_s", "s", "Time in which the tip is nearer than 0.5 mm to the globe", Category::tissue,
       of, Gather::sum, false, seconds_while<is_near>, true},
      {"out_of_focus_mm", "mm", "Mean distance between tip and focal plane", Category::microscope,
       of, Gather::mean, false, each_step<out_of_focus_mm>},
      {"unlit_s", "s", "Time in which the tip is outside of the lamp's cone", Category::microscope,
       of, Gather::sum, false, seconds_while<is_unlit>},
  };
}

}  // namespace supple
