// The subjects that `supple stress` runs: every model, the inversion, pictures and a live session,
// each with what it promises under every extreme that does not name a refusal.
#pragma once

#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/stress/stress_input.h"
#include "tools/lab/stress/stress_verdict.h"

namespace supple::tools {

/// Parts of the input. An extreme changes some, and concerns the models that depend on them: limits
/// those that know limits, and so on.
enum StressPart : unsigned {
  kOfBody = 1,    // its shape, its grid, its handle, its values
  kOfLimits = 2,  // of links
  kOfStiffness = 4,
  kOfPoisson = 8,
  kOfSteps = 16,     // of time
  kOfView = 32,      // size, camera
  kOfTransfer = 64,  // colours and opacities
  kOfSession = 128,  // its operations
  kOfBones = 256     // of a head CT
};

struct StressModel {
  const char* name;
  const char* title;
  unsigned parts;       // StressPart that it depends on
  const char* promise;  // what is measured, with the bounds
  void (*set)(StressInput& input);
  void (*run)(const StressInput& input, const std::string& folder, Console& console,
              MeasuredValues& all);
};

/// All of them. A new model is one line.
const std::vector<StressModel>& stress_models();

}  // namespace supple::tools
