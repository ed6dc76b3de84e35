// The rows `update` of the inversion benchmark: from a drag of a head to offsets that a renderer
// can take over (issue "first deformed frame").
#pragma once

#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/bench/report/report.h"
#include "volumes/base/vec.h"

namespace supple::tools {

/// A head of that size with a shell of two voxels, dragged out of rest at the cheek so that about
/// `wanted` elements move, `events` times: one row per number of threads. The timed part brings the
/// extended displacement and the inversion up to date. Throws Error when the outcome has not the
/// bits of a full inversion, Cancelled.
std::vector<BenchRow> measure_update(const Vec3i& size, std::int64_t wanted,
                                     const std::vector<int>& threads, int events, Console& console);

}  // namespace supple::tools
