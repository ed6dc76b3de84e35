// Close pictures of an incision that gapes, beside those of the same tissue uncut: what samples
// that find their own offsets beside a cut cost (volumes/field/cuts/cut_offsets.h).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/lab/bench/report/report.h"
#include "tools/lab/bench/report/timing.h"
#include "volumes/geometry/geometry.h"

namespace supple::tools {

struct CutSide {
  std::string setting;  // default, accurate
};

std::vector<CutSide> cut_sides();
std::string cut_row_name(const CutSide& side);

/// One thread; every picture in turns with that of the head at rest, and with that of the head in
/// which both lips went the same way, uncut.
std::vector<BenchRow> measure_cut(const Vec3i& size, int image_size,
                                  const std::vector<CutSide>& sides, const RoundLimits& limits,
                                  const std::function<void()>& before_run);

}  // namespace supple::tools
