// The rows `update` of the renderer's benchmark: from the end of a drag to its first picture, with
// the inverse brought up to date or without one.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/bench/report/report.h"
#include "volumes/base/vec.h"

namespace supple::tools {

struct RenderUpdateSide {
  std::string method;  // "inverse", or "forward": without one
  int threads = 1;
};

std::vector<RenderUpdateSide> update_sides(int threads);
std::string update_row_name(const RenderUpdateSide& side);

/// A head of that size with a shell of two voxels, dragged out of rest at the cheek so that about
/// `wanted` elements move, `events` times. The time of a row is all that comes between the solver
/// and the first ray: extension, inversion or gathering, the renderer's bricks, its bounds. Throws
/// Error when a followed picture differs from that of an inversion of everything, Cancelled.
std::vector<BenchRow> measure_render_update(const Vec3i& size, int image_size, std::int64_t wanted,
                                            const std::vector<RenderUpdateSide>& sides, int events,
                                            Console& console);

}  // namespace supple::tools
