// VTK's fixed-point ray caster beside the marcher: straight frames of one head, camera, transfer
// function and light. The limits of the comparison are in docs/benchmarks/render.md.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/bench/report/report.h"
#include "tools/lab/bench/report/timing.h"

namespace supple::tools {

struct StraightSide {
  std::string renderer;  // supple or vtk
  std::string shading;   // blinn or none
  std::string setting;   // a step in voxels, or one of our qualities
  int threads = 1;
};

std::vector<StraightSide> straight_sides(int threads);
std::string straight_row_name(const StraightSide& side);

/// Sides of one shading take turns. Empty, with a note, where VTK is not installed.
std::vector<BenchRow> measure_straight(const std::vector<StraightSide>& sides,
                                       const RoundLimits& limits, Console& console,
                                       const std::function<void()>& before_run);

}  // namespace supple::tools
