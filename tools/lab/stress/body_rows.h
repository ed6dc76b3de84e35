// Rows whose model moves a body: the scene is run by the stage that `supple run` uses, and its
// result is measured anew, not only read from its report.
#pragma once

#include "tools/console/console.h"
#include "tools/lab/stress/stress_input.h"
#include "tools/lab/stress/stress_verdict.h"

namespace supple::tools {

/// Each writes the input into the folder, runs it and adds what was measured. Throws as a scene
/// does.
void run_ecm(const StressInput& input, const std::string& folder, Console& console,
             MeasuredValues& all);
void run_ball(const StressInput& input, const std::string& folder, Console& console,
              MeasuredValues& all);
void run_relaxed(const StressInput& input, const std::string& folder, Console& console,
                 MeasuredValues& all);
void run_springs_at_rest(const StressInput& input, const std::string& folder, Console& console,
                         MeasuredValues& all);
/// Steps are StressInput::spring_step of the longest stable one. In a second step the handle stays.
void run_springs(const StressInput& input, const std::string& folder, Console& console,
                 MeasuredValues& all);
void run_fem(const StressInput& input, const std::string& folder, Console& console,
             MeasuredValues& all);
void run_inverse(const StressInput& input, const std::string& folder, Console& console,
                 MeasuredValues& all);
/// Gibson's algorithm, which knows no anchors; it is in no scene.
void run_original(const StressInput& input, const std::string& folder, Console& console,
                  MeasuredValues& all);

}  // namespace supple::tools
