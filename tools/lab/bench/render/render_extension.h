// Error of a picture whose displacement is known on the elements alone: extended into the air and
// inverted, against the exact offsets of an analytic deformation.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/lab/bench/report/report.h"
#include "tools/lab/bench/report/timing.h"

namespace supple::tools {

struct ExtensionSide {
  std::string warp;  // bump, shear, stretch
  std::string air;   // u in the air around the elements: extended, analytic, or zero
};

/// `quick`: one deformation.
std::vector<ExtensionSide> extension_sides(bool quick);
std::string extension_row_name(const ExtensionSide& side);

/// Times the frame, one thread, and compares it.
std::vector<BenchRow> measure_extension(const std::vector<ExtensionSide>& sides,
                                        const RoundLimits& limits,
                                        const std::function<void()>& before_run);

}  // namespace supple::tools
