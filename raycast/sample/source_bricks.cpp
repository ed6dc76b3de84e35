#include "raycast/sample/source_bricks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <thread>

#include <oneapi/tbb/parallel_for.h>

#include "volumes/grid/b_spline.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

constexpr double kCodes = 32767;  // encoded values lie in -kCodes … kCodes

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
  Survey found;
  found.lo.fill(HUGE_VALF);
  found.hi.fill(-HUGE_VALF);
  for_each_active(m_topology.mask(b), [&](int offset) {
    const float value = m_values[b] != nullptr ? m_values[b][offset] : m_density.background();
    if (!std::isfinite(value)) return;
    found.integers = found.integers && value == std::floor(value);
    const Vec3i local = brick_local(offset);
    const int lowest = (local.x == 0 ? 4 : 0) | (local.y == 0 ? 2 : 0) | (local.z == 0 ? 1 : 0);
    found.lo[0] = std::min(found.lo[0], value);
    found.hi[0] = std::max(found.hi[0], value);
    for (std::size_t part = 1; lowest != 0 && part < 8; ++part) {
      if ((int(part) & ~lowest) != 0) continue;
      found.lo[part] = std::min(found.lo[part], value);
      found.hi[part] = std::max(found.hi[part], value);
    }
  });
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
  EncodedRange range;
  for (std::size_t part = 0; part < 8; ++part) {
    const Vec3i above = cell_corner(int(part)) * kBrickDim;
    const std::int32_t from = m_topology.find(m_topology.origin(b) + above);
    if (from < 0) continue;
    const Survey& found = surveys[std::size_t(from)];
    if (found.lo[part] > found.hi[part]) continue;
    range.add(float(encode(found.lo[part])));
    range.add(float(encode(found.hi[part])));
  }
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
