#include <algorithm>
#include <map>
#include <utility>

#include "lib/operation/measure.h"

namespace supple {

namespace {

/// Touches of the same instrument and obstacle that are apart by less than this are one.
constexpr double kOneTouch_s = 0.25;

bool is_meant(const MeasureScope& scope, const OperationEvent& event) {
  return (scope.instrument.empty() || event.instrument == scope.instrument) &&
         (scope.at.empty() || event.at == scope.at);
}

enum class OfEvent { count, value, largest_value };

/// A number of the events of one kind in a step.
template <const char* const& kind, OfEvent what>
StepNumber of_events(const MeasureScope& scope) {
  return [scope](const OperationStep& step) {
    double number = 0;
    for (const OperationEvent& event : step.sample.events) {
      if (event.kind != kind || !is_meant(scope, event)) continue;
      if (what == OfEvent::count) number += 1;
      if (what == OfEvent::value) number += event.value;
      if (what == OfEvent::largest_value) number = std::max(number, event.value);
    }
    return number;
  };
}

const char* const kTouch = "touch";
const char* const kBleeding = "bleeding";
const char* const kTorn = "edge_torn";
const char* const kGripped = "gripped";
const char* const kLost = "piece_lost";

StepNumber touches(const MeasureScope& scope) {
  using Pair = std::pair<std::string, std::string>;
  return [scope, last_s = std::map<Pair, double>()](const OperationStep& step) mutable {
    double begun = 0;
    for (const OperationEvent& event : step.sample.events) {
      if (event.kind != kTouch || !is_meant(scope, event)) continue;
      const double now_s = step.sample.time_s;
      const auto [last, is_first] = last_s.try_emplace({event.instrument, event.at}, now_s);
      if (is_first || now_s - last->second >= kOneTouch_s) begun += 1;
      last->second = now_s;
    }
    return begun;
  };
}

StepNumber touch_time(const MeasureScope& scope) {
  return [scope](const OperationStep& step) {
    const auto& events = step.sample.events;
    const bool is_touching =
        std::any_of(events.begin(), events.end(), [&](const OperationEvent& event) {
          return event.kind == kTouch && is_meant(scope, event);
        });
    return is_touching ? step.dt_s : 0;
  };
}

StepNumber targets_lost(const MeasureScope& scope) {
  return [scope](const OperationStep& step) {
    double lost = 0;
    for (const OperationEvent& event : step.task_events) {
      if (event.kind == "target_lost" && is_meant(scope, event)) lost += 1;
    }
    return lost;
  };
}

}  // namespace

std::vector<MeasureKind> event_measures() {
  using Category = ScoreCategory;
  const auto of = MeasureOf::events;
  const auto at = MeasureOf::places;
  return {
      {"touches", "", "Touches of an obstacle", Category::tissue, at, Gather::sum, false, touches},
      {"touch_force_n", "N", "Largest force of a touch", Category::tissue, at, Gather::largest,
       false, of_events<kTouch, OfEvent::largest_value>},
      {"touch_time_s", "s", "Time of touching an obstacle", Category::tissue, at, Gather::sum,
       false, touch_time},
      {"bleedings", "", "Spots of blood", Category::tissue, at, Gather::sum, false,
       of_events<kBleeding, OfEvent::count>},
      {"bleeding_mm2", "mm2", "Area of all spots of blood", Category::tissue, at, Gather::sum,
       false, of_events<kBleeding, OfEvent::value>},
      {"torn_mm", "mm", "Length of torn edges of membranes", Category::tissue, at, Gather::sum,
       false, of_events<kTorn, OfEvent::value>},
      {"pieces_lost", "", "Pieces of membranes that were torn off", Category::tissue, at,
       Gather::sum, false, of_events<kLost, OfEvent::count>},
      {"grips", "", "Times that a membrane was gripped", Category::instruments, at, Gather::sum,
       false, of_events<kGripped, OfEvent::count>},
      {"targets_lost", "", "Times that a target was left before its time", Category::target, of,
       Gather::sum, false, targets_lost},
  };
}

}  // namespace supple
