#include "raycast/sample/source_bricks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>

#include "volumes/grid/b_spline.h"

namespace supple {

namespace {

constexpr double kCodes = 32767;  // encoded values lie in -kCodes … kCodes

/// Range and integrality of the active densities.
struct DensitySurvey {
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  bool integers = true;
};

DensitySurvey survey(const BrickTopology& where, const std::vector<const float*>& values,
                     float background) {
  DensitySurvey result;
  for (std::size_t b = 0; b < where.brick_count(); ++b) {
    for_each_active(where.mask(b), [&](int offset) {
      const float value = values[b] != nullptr ? values[b][offset] : background;
      if (!std::isfinite(value)) return;
      result.lo = std::min(result.lo, double(value));
      result.hi = std::max(result.hi, double(value));
      result.integers = result.integers && value == std::floor(value);
    });
  }
  return result;
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
    : m_interpolation(interpolation), m_topology(where) {
  const std::size_t count = m_topology.brick_count();
  Values values(count);
  for (std::size_t b = 0; b < count; ++b) {
    const std::int32_t from = density.bricks().find(m_topology.origin(b));
    if (from >= 0) values[b] = density.values(from);
  }
  std::vector<float> coefficients;
  if (interpolation == Interpolation::interpolating) {
    coefficients = b_spline_coefficients(m_topology, values, density.background());
    for (std::size_t b = 0; b < count; ++b) values[b] = &coefficients[b * kBrickVoxels];
  }
  choose_encoding(density, values);
  m_nodes.resize(count * kBrickNodes, kVoid);
  m_ranges.resize(count);
  tbb::parallel_for(std::size_t(0), count,
                    [&](std::size_t b) { fill_brick(values, density.background(), b); });
  for (const EncodedRange& range : m_ranges) m_range.add(range);
}

void SourceBricks::choose_encoding(const DensityGrid& density, const Values& values) {
  const DensitySurvey found = survey(m_topology, values, density.background());
  if (found.lo > found.hi) return;
  // Integers keep their values, whatever part of a volume is given, so that a state and its volume
  // read the same bits.
  if (found.integers && found.lo >= -kCodes && found.hi <= kCodes) return;
  if (found.integers && found.lo >= 0 && found.hi <= 2 * kCodes) {
    m_offset = kCodes;
    return;
  }
  const double middle = 0.5 * (found.lo + found.hi);
  const bool exact = found.integers && found.hi - found.lo <= 2 * kCodes - 1;
  m_offset = exact ? std::floor(middle) : middle;
  m_scale = exact || found.hi == found.lo ? 1.0 : (found.hi - found.lo) / (2 * kCodes);
}

std::int16_t SourceBricks::encode(float density) const {
  if (!std::isfinite(density)) return kVoid;
  const double code = std::round((double(density) - m_offset) / m_scale);
  return std::int16_t(std::clamp(code, -kCodes, kCodes));
}

void SourceBricks::fill_brick(const Values& values, float background, std::size_t b) {
  const Vec3i origin = m_topology.origin(b);
  std::array<std::int32_t, 27> neighbours;
  for (int n = 0; n < 27; ++n) {
    const Vec3i side(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
    neighbours[n] = m_topology.find(origin + side * kBrickDim);
  }
  EncodedRange range;
  std::int16_t* out = &m_nodes[b * kBrickNodes];
  for (int x = -1; x < kDim - 1; ++x) {
    for (int y = -1; y < kDim - 1; ++y) {
      for (int z = -1; z < kDim - 1; ++z, ++out) {
        const int n = 9 * side_of(x) + 3 * side_of(y) + side_of(z) + 13;
        const std::int32_t from = neighbours[n];
        const int offset = brick_offset({x, y, z});
        if (from < 0 || !mask_test(m_topology.mask(from), offset)) continue;
        *out = encode(values[from] != nullptr ? values[from][offset] : background);
        // A cubic sample reads one node more on every side.
        const bool is_reached = m_interpolation != Interpolation::linear ||
                                (std::min({x, y, z}) >= 0 && std::max({x, y, z}) <= kBrickDim);
        if (is_reached && *out != kVoid) range.add(float(*out));
      }
    }
  }
  m_ranges[b] = range;
}

std::size_t SourceBricks::bytes() const {
  return m_topology.bytes() + m_nodes.capacity() * sizeof(std::int16_t) +
         m_ranges.capacity() * sizeof(EncodedRange);
}

}  // namespace supple
