#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "volumes/base/simd.h"
#include "volumes/grid/brick_topology.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

using DensityRow = Pack<float, 8>;
using DensityBits = Pack<std::int32_t, 8>;
constexpr DensityBits kLaneBit = {1, 2, 4, 8, 16, 32, 64, 128};

/// Smallest and largest value of every lane; lo > hi: none.
struct LaneRange {
  DensityRow lo = DensityRow{} + HUGE_VALF, hi = DensityRow{} - HUGE_VALF;

  void add(const DensityRow& values) {
    lo = values < lo ? values : lo;
    hi = values > hi ? values : hi;
  }
  void add(const DensityRow& values, const DensityBits& counts) {
    lo = (counts & (values < lo)) ? values : lo;
    hi = (counts & (values > hi)) ? values : hi;
  }
  DensityBits reaches(float limit) const { return (lo <= -limit) | (hi >= limit); }
};

/// A value below kSmall and kUnits add up to a float whose last place is 1.
constexpr float kSmall = 4194304, kUnits = 3 * kSmall;

/// Lanes with a value that is no integer; all are small or not finite.
DensityBits have_fractions(const DensityRow& values) {
  return (values + kUnits) - kUnits != values;
}
/// The same of any values.
DensityBits have_fractions_anywhere(const DensityRow& values) {
  const DensityBits is_small =
      (values < 2 * kSmall) & (values > -2 * kSmall);  // others are integers
  const DensityRow small = is_small ? values : DensityRow{};
  return __builtin_convertvector(__builtin_convertvector(small, DensityBits), DensityRow) != small;
}

bool any_of(const DensityBits& lanes) {
  std::int32_t any = 0;
  for (int z = 0; z < kBrickDim; ++z) any |= lanes[z];
  return any != 0;
}

}  // namespace

BrickExtremes find_extremes(const float* values, const BrickMask& mask) {
  // Ranges of all rows along z, those at x = 0, those at y = 0 and the one at both; a lane is a z.
  std::array<LaneRange, 4> rows;
  const auto add_rows = [&](const auto& add_row) {
    rows = {};
    for (int x = 0; x < kBrickDim; ++x) {
      for (int y = 0; y < kBrickDim; ++y) add_row(x, y, rows[0]);
      add_row(0, x, rows[1]);
      add_row(x, 0, rows[2]);
    }
    add_row(0, 0, rows[3]);
  };
  const auto row_at = [&](int x, int y) {
    DensityRow row;
    std::memcpy(&row, values + brick_offset({x, y, 0}), sizeof row);
    return row;
  };
  DensityBits is_odd{}, fractions{};  // not finite; no integers
  if (is_full(mask)) {
    add_rows([&](int x, int y, LaneRange& range) { range.add(row_at(x, y)); });
    for (int n = 0; n < kBrickDim * kBrickDim; ++n) {
      const DensityRow row = row_at(n / kBrickDim, n % kBrickDim);
      is_odd |= row - row != 0;
      fractions |= have_fractions(row);
    }
  }
  if (!is_full(mask) || any_of(is_odd) || any_of(rows[0].reaches(kSmall))) {
    fractions = DensityBits{};
    add_rows([&](int x, int y, LaneRange& range) {
      const auto bits = int(mask[std::size_t(x)] >> (8 * y)) & 0xff;
      const DensityRow row = row_at(x, y);
      const DensityBits counts = (((DensityBits{} + bits) & kLaneBit) != 0) & (row - row == 0);
      range.add(row, counts);
      fractions |= counts & have_fractions_anywhere(row);
    });
  }
  BrickExtremes found;
  found.integers = !any_of(fractions);
  for (std::size_t part = 0; part < BrickExtremes::kParts; ++part) {
    const LaneRange& range = rows[(part & 4) / 4 + (part & 2)];
    found.lo[part] = range.lo[0];
    found.hi[part] = range.hi[0];
    for (int z = 1; z < kBrickDim && (part & 1) == 0; ++z) {
      found.lo[part] = std::min(found.lo[part], range.lo[z]);
      found.hi[part] = std::max(found.hi[part], range.hi[z]);
    }
  }
  return found;
}

}  // namespace supple
