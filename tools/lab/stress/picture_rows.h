// Rows whose result is a picture.
#pragma once

#include "tools/console/console.h"
#include "tools/lab/stress/stress_input.h"
#include "tools/lab/stress/stress_verdict.h"

namespace supple::tools {

/// Runs the scene, reads the picture file that it leaves, and draws the view once more into
/// numbers. Throws as a scene does.
void run_picture(const StressInput& input, const std::string& folder, Console& console,
                 MeasuredValues& all);

}  // namespace supple::tools
