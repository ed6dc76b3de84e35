#include "raycast/sample/source_bricks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <thread>

#include "volumes/base/memory.h"
#include "volumes/base/parallel.h"
#include "volumes/grid/b_spline.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

constexpr double kCodes = 32767;  // encoded values lie in -kCodes … kCodes

/// The extremes of bricks are found one after the other, and mostly wait for memory.
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

/// A cubic sample reads one node more on every side, of which the extremes do not tell.
void SourceBricks::fill_all() {
  parallel_for(m_ranges.size(), [&](std::size_t b) {
    m_ranges[b] = fill(b);
    m_states[b] = kFilled;
  });
  m_values.clear();
  m_density = DensityGrid();
}

/// Finds the extremes of all bricks by reading their densities.
std::vector<BrickExtremes> SourceBricks::look_for_extremes() const {
  std::vector<BrickExtremes> extremes(m_topology.brick_count());
  const std::vector<float> background(kBrickVoxels, m_density.background());
  parallel_for(extremes.size(), [&](std::size_t b) {
    if (b + kAhead < extremes.size()) prefetch(values(b + kAhead));
    const float* const stored = values(b);
    extremes[b] = find_extremes(stored != nullptr ? stored : background.data(), m_topology.mask(b));
  });
  return extremes;
}

/// Densities that the cells of each brick reach, encoded. Cells reach by one node into the bricks
/// above.
void SourceBricks::find_ranges() {
  std::vector<BrickExtremes> found;
  const BrickExtremes* extremes = m_values.empty() ? m_density.extremes() : nullptr;
  if (extremes == nullptr) {
    found = look_for_extremes();
    extremes = found.data();
  }
  const std::size_t count = m_topology.brick_count();
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  bool integers = true;
  for (std::size_t b = 0; b < count; ++b) {
    lo = std::min(lo, double(extremes[b].lo[0]));
    hi = std::max(hi, double(extremes[b].hi[0]));
    integers = integers && extremes[b].integers;
  }
  choose_encoding(lo, hi, integers);
  parallel_for(count, [&](std::size_t b) {
    float least = HUGE_VALF, largest = -HUGE_VALF;
    for (std::size_t part = 0; part < BrickExtremes::kParts; ++part) {
      const Vec3i step = cell_corner(int(part)) * kBrickDim;
      const std::int32_t from =
          part == 0 ? std::int32_t(b) : m_topology.find(m_topology.origin(b) + step);
      if (from < 0) continue;
      least = std::min(least, extremes[from].lo[part]);
      largest = std::max(largest, extremes[from].hi[part]);
    }
    if (least <= largest) m_ranges[b] = {float(encode(least)), float(encode(largest))};
  });
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
