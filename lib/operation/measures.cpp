#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "lib/operation/measure.h"

namespace supple {

const std::vector<std::string>& category_keys() {
  static const std::vector<std::string> kKeys = {"tissue", "efficiency", "target", "instruments",
                                                 "microscope"};
  return kKeys;
}

Fields fields(OperationSurroundings& around) {
  return {
      Field("globe_centre", around.globe_centre_mm, "Centre of the globe [x, y, z]").unit("mm"),
      Field("globe_radius", around.globe_radius_mm, "Radius of the globe; 0: there is none")
          .unit("mm")
          .at_least(0),
      Field("lamp", around.lamp, "Instrument that lights the place"),
      Field("lamp_cone", around.lamp_cone_degrees, "Half of the cone of its light")
          .unit("degrees")
          .range(0, 90),
      Field("view", around.view, "From the focal plane to the microscope [x, y, z]"),
  };
}

namespace {

/// Changes that are apart by less than this are one.
constexpr double kOneChange_s = 0.5;

/// Counts the beginnings of runs of change.
StepNumber changes_of(std::function<double(const OperationSample&, const OperationSample&)> change,
                      double least) {
  return [change = std::move(change), least, before = OperationSample(), changed_s = -kOneChange_s,
          has_begun = false](const OperationStep& step) mutable {
    const bool is_changed = has_begun && change(before, step.sample) > least;
    has_begun = true;
    before.zoom = step.sample.zoom;
    before.focus_mm = step.sample.focus_mm;
    if (!is_changed) return 0.0;
    const bool is_new = step.sample.time_s - changed_s >= kOneChange_s;
    changed_s = step.sample.time_s;
    return is_new ? 1.0 : 0.0;
  };
}

std::vector<MeasureKind> operation_measures() {
  const auto of = MeasureOf::operation;
  return {
      {"time_s", "s", "Time until all tasks are done, or to the end", ScoreCategory::efficiency, of,
       Gather::sum, false,
       [](const MeasureScope&) -> StepNumber {
         return [was_done = false](const OperationStep& step) mutable {
           return std::exchange(was_done, step.is_done) ? 0 : step.dt_s;
         };
       }},
      {"task_part", "part", "Mean part of the tasks that is done", ScoreCategory::target, of,
       Gather::last, true,
       [](const MeasureScope&) -> StepNumber {
         return [](const OperationStep& step) { return step.task_part; };
       }},
      {"turn_degrees", "degrees", "Largest turn of the eye", ScoreCategory::instruments, of,
       Gather::largest, false,
       [](const MeasureScope&) -> StepNumber {
         return [](const OperationStep& step) { return step.sample.turn_degrees.length(); };
       }},
      {"zoom_changes", "", "Times that the zoom was turned", ScoreCategory::microscope, of,
       Gather::sum, false,
       [](const MeasureScope&) {
         return changes_of([](const auto& a, const auto& b) { return std::abs(b.zoom - a.zoom); },
                           1e-4);
       }},
      {"focus_changes", "", "Times that the focus was turned", ScoreCategory::microscope, of,
       Gather::sum, false,
       [](const MeasureScope&) {
         return changes_of(
             [](const auto& a, const auto& b) { return (b.focus_mm - a.focus_mm).length(); }, 1e-4);
       }},
  };
}

}  // namespace

const std::vector<MeasureKind>& measure_kinds() {
  static const std::vector<MeasureKind> kKinds = [] {
    std::vector<MeasureKind> all;
    for (const auto& rows : {event_measures(), tip_measures(), operation_measures()}) {
      all.insert(all.end(), rows.begin(), rows.end());
    }
    return all;
  }();
  return kKinds;
}

std::vector<std::string> measure_names() {
  std::vector<std::string> names;
  for (const MeasureKind& kind : measure_kinds()) names.push_back(kind.name);
  return names;
}

const MeasureKind& measure_kind(const std::string& name) {
  const auto& kinds = measure_kinds();
  const auto found = std::find_if(kinds.begin(), kinds.end(),
                                  [&](const MeasureKind& kind) { return name == kind.name; });
  if (found == kinds.end()) throw std::invalid_argument("no measure \"" + name + "\"");
  return *found;
}

void GatheredMeasure::take(const OperationStep& step) {
  const double number = m_number(step);
  const bool is_first = !std::exchange(m_has_begun, true);
  m_time_s += step.dt_s;
  switch (m_gather) {
    case Gather::sum:
      m_value += number;
      break;
    case Gather::largest:
      m_value = is_first ? number : std::max(m_value, number);
      break;
    case Gather::least:
      m_value = is_first ? number : std::min(m_value, number);
      break;
    case Gather::mean:
      m_value += number * step.dt_s;
      break;
    case Gather::root_mean_square:
      m_value += number * number * step.dt_s;
      break;
    case Gather::last:
      m_value = number;
      break;
  }
}

double GatheredMeasure::value() const {
  if (m_gather != Gather::mean && m_gather != Gather::root_mean_square) return m_value;
  if (m_time_s == 0) return 0;
  const double mean = m_value / m_time_s;
  return m_gather == Gather::mean ? mean : std::sqrt(mean);
}

}  // namespace supple
