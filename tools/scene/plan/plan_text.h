// A plan as a table for people, and as JSON.
#pragma once

#include <string>

#include "tools/scene/plan/scene_plan.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// Stage, what, why, memory and time of every row; what is left out; the sums.
std::string text_of_plan(const ScenePlan& plan);
Value to_value(const ScenePlan& plan);

/// Outcome of a plan that was carried out.
struct PlanOutcome {
  double peak_mb = 0;            // of the process
  double seconds = 0;            // of all stages
  double processor_seconds = 0;  // of all threads, without the planning
};
/// Writes "planned …, took …" of peak memory and time.
std::string outcome_text(const ScenePlan& plan, const PlanOutcome& outcome);
Value outcome_json(const ScenePlan& plan, const PlanOutcome& outcome);

}  // namespace supple::tools
