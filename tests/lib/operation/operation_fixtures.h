// Samples of operations without an eye: a needle that is led along a way, with tremor, touches and
// detours.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lib/operation/score.h"

namespace supple::test {

constexpr double kStep_s = 0.02;
constexpr double kGlobe_mm = 11;

using Samples = std::vector<OperationSample>;

/// Samples of one instrument whose tip is where `tip` says, in steps of kStep_s.
Samples samples_of(double seconds, const std::function<Vec3d(double time_s)>& tip);

/// A plan of one needle, with the globe about the origin and nothing else.
OperationPlan needle_plan();
ScoreRule rule_of(const std::string& measure);
/// What a rule measures of the samples.
double measured(const Samples& samples, OperationPlan plan, const ScoreRule& rule);
double measured(const Samples& samples, const std::string& measure);

OperationScore score_of(const OperationPlan& plan, const Samples& samples);
/// Samples with the events of the plan's tasks, as a log has them.
Samples with_task_events(const OperationPlan& plan, Samples samples);

/// How one leads a needle 1.5 mm from the retina from target to target.
struct Expert {
  double tremor_mm = 0.1;  // root mean square of a coordinate, at 8, 9 and 10 Hz
  int rounds = 0;          // of a detour about the posterior pole
  bool touches = false;    // the retina, once
};
Samples expert_samples(const Expert& expert);
/// Its tasks: the three targets; rules: the default ones.
OperationPlan expert_plan();

}  // namespace supple::test
