// "Deform, then show": from a drag to the first picture, by ITK's warp and VTK's fixed-point ray
// caster as people do it without Supple, and by `supple`, side by side.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/bench/report/report.h"
#include "tools/lab/bench/report/timing.h"

namespace supple::tools {

/// One way to the picture.
struct ShowSide {
  /// process: programs that start, read files and write a picture; session: a viewer that holds
  /// the volume, after a drag; session-local: after one of 3 mm in place of 12.
  std::string mode;
  /// supple: of a drag's state; supple-no-inverse: the same, samples solving for themselves;
  /// supple-warp: `supple render --offsets` of ITK's own inputs; itk+vtk.
  std::string pipeline;
  int threads = 1;
};

std::vector<ShowSide> show_sides(int threads);
std::string show_row_name(const ShowSide& side);

/// Sides of one mode take turns; all have as many threads. Those of peers that are not installed
/// are left out, with a note.
std::vector<BenchRow> measure_show(const std::vector<ShowSide>& sides, const RoundLimits& limits,
                                   Console& console, const std::function<void()>& before_run);

}  // namespace supple::tools
