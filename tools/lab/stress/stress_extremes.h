// Extremes under which `supple stress` runs the models, and where one of them is refused instead.
#pragma once

#include <string>
#include <vector>

#include "tools/lab/stress/stress_models.h"
#include "tools/lab/stress/stress_verdict.h"

namespace supple::tools {

struct StressRefusal : ExpectedRefusal {
  std::vector<std::string> models = {};  // by name; empty: all
};

struct StressExtreme {
  const char* name;
  const char* title;
  unsigned parts;  // StressPart that it changes; it concerns the models that depend on one of them
  void (*set)(StressInput& input);
  std::vector<StressRefusal> refusals = {};
  bool is_long = false;                  // left out unless asked for
  double limit_s = 20;                   // of wall time
  double limit_mb = 1000;                // of resident memory
  std::vector<std::string> models = {};  // these alone; empty: all that it concerns
};

/// All of them. A new extreme is one line.
const std::vector<StressExtreme>& stress_extremes();

}  // namespace supple::tools
