#include "raycast/sample/source_bricks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <thread>

#include <oneapi/tbb/parallel_for.h>

#include "volumes/grid/b_spline.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

constexpr double kCodes = 32767;  // encoded values lie in -kCodes … kCodes

using Lanes = float __attribute__((vector_size(32)));
using LaneBits = std::int32_t __attribute__((vector_size(32)));
constexpr LaneBits kLaneBit = {1, 2, 4, 8, 16, 32, 64, 128};

/// Smallest and largest value of every lane; lo > hi: none.
struct RowRange {
  Lanes lo = Lanes{} + HUGE_VALF, hi = Lanes{} - HUGE_VALF;

  void add(const Lanes& values, const LaneBits& counts) {
    lo = (counts & (values < lo)) ? values : lo;
    hi = (counts & (values > hi)) ? values : hi;
  }
};

/// Whether the values that count are; floats from 2^23 on have no other.
bool are_integers(const Lanes& values, const LaneBits& counts) {
  constexpr float kAllIntegers = 8388608;
  const LaneBits small = (values < kAllIntegers) & (values > -kAllIntegers);
  const Lanes rounded = __builtin_convertvector(
      __builtin_convertvector((small & counts) ? values : Lanes{}, LaneBits), Lanes);
  const LaneBits others = counts & small & (rounded != values);
  std::int32_t any = 0;
  for (int z = 0; z < kBrickDim; ++z) any |= others[z];
  return any == 0;
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
      m_values(where.brick_count()),
      m_nodes(new std::int16_t[where.brick_count() * kBrickNodes]),
      m_states(new std::atomic<std::uint8_t>[where.brick_count()]()),
      m_ranges(where.brick_count()) {
  const std::size_t count = m_topology.brick_count();
  for (std::size_t b = 0; b < count; ++b) {
    const std::int32_t from = density.bricks().find(m_topology.origin(b));
    if (from >= 0) m_values[b] = density.values(from);
  }
  std::vector<float> coefficients;
  if (interpolation == Interpolation::interpolating) {
    coefficients = b_spline_coefficients(m_topology, m_values, density.background());
    for (std::size_t b = 0; b < count; ++b) m_values[b] = &coefficients[b * kBrickVoxels];
  }
  std::vector<Survey> surveys(count);
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t b) { surveys[b] = survey(b); });
  choose_encoding(surveys);
  // A cubic sample reads one node more on every side, of which the surveys do not tell.
  const bool is_linear = interpolation == Interpolation::linear;
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t b) {
    m_ranges[b] = is_linear ? range_of(surveys, b) : fill(b);
    if (!is_linear) m_states[b] = kFilled;
  });
  for (const EncodedRange& range : m_ranges) m_range.add(range);
  if (is_linear) return;
  m_values.clear();
  m_density = DensityGrid();
}

SourceBricks::Survey SourceBricks::survey(std::size_t b) const {
  // Of all rows along z, those at x = 0, those at y = 0 and the one at both; a lane is a z.
  std::array<RowRange, 4> rows;
  bool integers = true;
  const Lanes background = Lanes{} + m_density.background();
  for (int x = 0; x < kBrickDim; ++x) {
    for (int y = 0; y < kBrickDim; ++y) {
      const auto bits = unsigned(m_topology.mask(b)[std::size_t(x)] >> (8 * y)) & 0xff;
      if (bits == 0) continue;
      Lanes values = background;
      if (m_values[b] != nullptr) std::memcpy(&values, m_values[b] + 64 * x + 8 * y, sizeof values);
      const LaneBits counts = (((LaneBits{} + int(bits)) & kLaneBit) != 0) & (values - values == 0);
      integers = integers && are_integers(values, counts);
      rows[0].add(values, counts);
      if (x == 0) rows[1].add(values, counts);
      if (y == 0) rows[2].add(values, counts);
      if (x + y == 0) rows[3].add(values, counts);
    }
  }
  Survey found;
  found.integers = integers;
  for (std::size_t part = 0; part < 8; ++part) {
    const RowRange& range = rows[(part & 4) / 4 + (part & 2)];
    found.lo[part] = range.lo[0];
    found.hi[part] = range.hi[0];
    for (int z = 1; z < kBrickDim && (part & 1) == 0; ++z) {
      found.lo[part] = std::min(found.lo[part], range.lo[z]);
      found.hi[part] = std::max(found.hi[part], range.hi[z]);
    }
  }
  return found;
}

void SourceBricks::choose_encoding(const std::vector<Survey>& surveys) {
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  bool integers = true;
  for (const Survey& found : surveys) {
    lo = std::min(lo, double(found.lo[0]));
    hi = std::max(hi, double(found.hi[0]));
    integers = integers && found.integers;
  }
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

/// Cells reach by one node into the bricks above.
EncodedRange SourceBricks::range_of(const std::vector<Survey>& surveys, std::size_t b) const {
  float lo = HUGE_VALF, hi = -HUGE_VALF;
  for (std::size_t part = 0; part < 8; ++part) {
    const Vec3i above = cell_corner(int(part)) * kBrickDim;
    const std::int32_t from =
        part == 0 ? std::int32_t(b) : m_topology.find(m_topology.origin(b) + above);
    if (from < 0) continue;
    lo = std::min(lo, surveys[std::size_t(from)].lo[part]);
    hi = std::max(hi, surveys[std::size_t(from)].hi[part]);
  }
  EncodedRange range;
  if (lo > hi) return range;
  range.add(float(encode(lo)));
  range.add(float(encode(hi)));
  return range;
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
        const float* const values = m_values[std::size_t(from)];
        *out = encode(values != nullptr ? values[offset] : m_density.background());
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
         count * (sizeof(EncodedRange) + sizeof(const float*) + 1);
}

}  // namespace supple
