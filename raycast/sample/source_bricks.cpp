#include "raycast/sample/source_bricks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <thread>

#include <oneapi/tbb/parallel_for.h>

#include "volumes/base/huge_pages.h"
#include "volumes/grid/b_spline.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

constexpr double kCodes = 32767;  // encoded values lie in -kCodes … kCodes

using DensityRow = float __attribute__((vector_size(32)));
using DensityBits = std::int32_t __attribute__((vector_size(32)));
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

/// Bricks are surveyed one after the other, and mostly wait for memory.
constexpr std::size_t kAhead = 1;
void prefetch(const float* values) {
  constexpr int kLine = 16;
  for (int n = 0; values != nullptr && n < kBrickVoxels; n += kLine) {
    __builtin_prefetch(values + n);
  }
}

/// -1, 0 or 1: the brick beside this one that holds a local coordinate.
int side_of(int local) {
  return local < 0 ? -1 : local < kBrickDim ? 0 : 1;
}

}  // namespace

void EncodedRange::add(float value) {
  if (empty()) {
    lo = hi = value;
    return;
  }
  lo = std::min(lo, value);
  hi = std::max(hi, value);
}

void EncodedRange::add(const EncodedRange& other) {
  if (other.empty()) return;
  add(other.lo);
  add(other.hi);
}

SourceBricks::SourceBricks(const DensityGrid& density, const BrickTopology& where,
                           Interpolation interpolation)
    : m_interpolation(interpolation),
      m_topology(where),
      m_density(density),
      m_nodes(new std::int16_t[where.brick_count() * kBrickNodes]),
      m_states(new std::atomic<std::uint8_t>[where.brick_count()]()),
      m_ranges(where.brick_count()) {
  const std::size_t count = m_topology.brick_count();
  ask_for_small_pages(m_nodes.get(), count * kBrickNodes * sizeof(std::int16_t));
  std::vector<float> coefficients;
  if (interpolation != Interpolation::linear || !(where == density.bricks())) {
    m_values.resize(count);
    for (std::size_t b = 0; b < count; ++b) {
      const std::int32_t from = density.bricks().find(m_topology.origin(b));
      if (from >= 0) m_values[b] = density.values(std::size_t(from));
    }
  }
  if (interpolation == Interpolation::interpolating) {
    coefficients = b_spline_coefficients(m_topology, m_values, density.background());
    for (std::size_t b = 0; b < count; ++b) m_values[b] = &coefficients[b * kBrickVoxels];
  }
  find_ranges();
  if (interpolation != Interpolation::linear) fill_all();
  for (const EncodedRange& range : m_ranges) m_range.add(range);
}

/// A cubic sample reads one node more on every side, of which the surveys do not tell.
void SourceBricks::fill_all() {
  tbb::parallel_for(std::size_t(0), m_ranges.size(), [&](std::size_t b) {
    m_ranges[b] = fill(b);
    m_states[b] = kFilled;
  });
  m_values.clear();
  m_density = DensityGrid();
}

SourceBricks::Survey SourceBricks::survey(std::size_t b) const {
  const BrickMask& mask = m_topology.mask(b);
  const float* const stored = values(b);
  if (b + kAhead < m_topology.brick_count()) prefetch(values(b + kAhead));
  // Of all rows along z, those at x = 0, those at y = 0 and the one at both; a lane is a z.
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
    DensityRow row = DensityRow{} + m_density.background();
    if (stored != nullptr) std::memcpy(&row, stored + 64 * x + 8 * y, sizeof row);
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
  Survey found;
  found.integers = !any_of(fractions);
  for (std::size_t part = 0; part < 8; ++part) {
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

/// Densities that the cells of each brick reach, encoded. Cells reach by one node into the bricks
/// above, so the surveys of two layers of bricks are enough at a time.
void SourceBricks::find_ranges() {
  const std::size_t count = m_topology.brick_count();
  const auto end_of_layer = [&](std::size_t b) {
    const std::size_t first = b;
    while (b < count && m_topology.origin(b).x == m_topology.origin(first).x) ++b;
    return b;
  };
  std::size_t begin = 0, end = 0;  // of the layer that waits for the one above it
  std::vector<Survey> layer, above;
  const auto find_range = [&](std::size_t b) {
    float lo = HUGE_VALF, hi = -HUGE_VALF;
    for (std::size_t part = 0; part < 8; ++part) {
      const Vec3i step = cell_corner(int(part)) * kBrickDim;
      const std::int32_t from =
          part == 0 ? std::int32_t(b) : m_topology.find(m_topology.origin(b) + step);
      if (from < 0) continue;
      const auto n = std::size_t(from);
      const Survey& found = n < end ? layer[n - begin] : above[n - end];
      lo = std::min(lo, found.lo[part]);
      hi = std::max(hi, found.hi[part]);
    }
    if (lo <= hi) m_ranges[b] = {lo, hi};
  };
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  bool integers = true;
  while (begin < count) {
    const std::size_t above_end = end_of_layer(end);
    above.resize(above_end - end);
    tbb::parallel_for(end, above_end, [&](std::size_t b) { above[b - end] = survey(b); });
    tbb::parallel_for(begin, end, find_range);
    for (const Survey& found : above) {
      lo = std::min(lo, double(found.lo[0]));
      hi = std::max(hi, double(found.hi[0]));
      integers = integers && found.integers;
    }
    begin = end;
    end = above_end;
    layer.swap(above);
  }
  choose_encoding(lo, hi, integers);
  for (EncodedRange& range : m_ranges) {
    if (!range.empty()) range = {float(encode(range.lo)), float(encode(range.hi))};
  }
}

void SourceBricks::choose_encoding(double lo, double hi, bool integers) {
  if (lo > hi) return;
  // Integers keep their values, whatever part of a volume is given, so that a state and its volume
  // read the same bits.
  if (integers && lo >= -kCodes && hi <= kCodes) return;
  if (integers && lo >= 0 && hi <= 2 * kCodes) {
    m_offset = kCodes;
    return;
  }
  const double middle = 0.5 * (lo + hi);
  const bool exact = integers && hi - lo <= 2 * kCodes - 1;
  m_offset = exact ? std::floor(middle) : middle;
  m_scale = exact || hi == lo ? 1.0 : (hi - lo) / (2 * kCodes);
}

std::int16_t SourceBricks::encode(float density) const {
  if (!std::isfinite(density)) return kVoid;
  const double code = std::round((double(density) - m_offset) / m_scale);
  return std::int16_t(std::clamp(code, -kCodes, kCodes));
}

EncodedRange SourceBricks::fill(std::size_t b) const {
  const Vec3i origin = m_topology.origin(b);
  std::array<std::int32_t, 27> neighbours;
  for (int n = 0; n < 27; ++n) {
    const Vec3i side(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
    neighbours[std::size_t(n)] = m_topology.find(origin + side * kBrickDim);
  }
  EncodedRange range;
  std::int16_t* out = &m_nodes[b * kBrickNodes];
  for (int x = -1; x < kDim - 1; ++x) {
    for (int y = -1; y < kDim - 1; ++y) {
      for (int z = -1; z < kDim - 1; ++z, ++out) {
        const int n = 9 * side_of(x) + 3 * side_of(y) + side_of(z) + 13;
        const std::int32_t from = neighbours[std::size_t(n)];
        const int offset = brick_offset({x, y, z});
        *out = kVoid;
        if (from < 0 || !mask_test(m_topology.mask(std::size_t(from)), offset)) continue;
        const float* const stored = values(std::size_t(from));
        *out = encode(stored != nullptr ? stored[offset] : m_density.background());
        if (*out != kVoid) range.add(float(*out));
      }
    }
  }
  *out = kVoid;
  return range;
}

void SourceBricks::fill_once(std::size_t b) const {
  std::uint8_t state = kEmpty;
  if (m_states[b].compare_exchange_strong(state, kFilling)) {
    fill(b);
    m_states[b].store(kFilled, std::memory_order_release);
    return;
  }
  while (m_states[b].load(std::memory_order_acquire) != kFilled) std::this_thread::yield();
}

std::size_t SourceBricks::bytes() const {
  const std::size_t count = m_topology.brick_count();
  std::size_t filled = 0;
  for (std::size_t b = 0; b < count; ++b) filled += m_states[b] == kFilled;
  return m_topology.bytes() + filled * kBrickNodes * sizeof(std::int16_t) +
         m_values.capacity() * sizeof(const float*) + count * (sizeof(EncodedRange) + 1);
}

}  // namespace supple
