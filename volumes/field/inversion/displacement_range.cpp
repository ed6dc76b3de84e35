#include "volumes/field/inversion/displacement_range.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/base/text.h"
#include "volumes/field/brick_nodes.h"
#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

// Offsets are floats: beyond a million voxels they no longer resolve a sixteenth of a voxel.
constexpr float kMaxDisplacement = 1e6f;

/// The range as two vectors, while it grows.
struct Range4 {
  Float4 lo = Float4{} + 3e38f, hi = Float4{} - 3e38f;

  void add(const Float4& v) {
    lo = v < lo ? v : lo;
    hi = v > hi ? v : hi;
  }
  void add(const Range4& other) {
    lo = other.lo < lo ? other.lo : lo;
    hi = other.hi > hi ? other.hi : hi;
  }
  VectorRange range() const { return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}}; }
};

[[noreturn]] void refuse(const Vec3i& voxel) {
  throw InputError({"", "displacement at voxel " + to_text(voxel, " "),
                    "a vector that is not finite or longer than 10^6 voxels",
                    "finite displacements"});
}

bool is_within_limits(const Vec3f& u) {
  return std::max({std::abs(u.x), std::abs(u.y), std::abs(u.z)}) <= kMaxDisplacement &&
         !std::isnan(u.x + u.y + u.z);
}

/// The brick above along the axes of n.
std::int32_t upper_brick(const BrickTopology& bricks, std::size_t b, int n) {
  if (n == 0) return std::int32_t(b);
  return bricks.find(bricks.origin(b) + cell_corner(n) * kBrickDim);
}

/// True if some voxel of the mask is 0 along x where n & 4, along y where n & 2, z where n & 1.
bool has_lowest(const BrickMask& mask, int n) {
  constexpr std::uint64_t kAll = ~std::uint64_t(0);
  const std::uint64_t rows = (n & 2 ? 0xff : kAll) & (n & 1 ? 0x0101010101010101 : kAll);
  std::uint64_t any = 0;
  for (std::size_t x = 0; x < (n & 4 ? 1 : mask.size()); ++x) any |= mask[x];
  return (any & rows) != 0;
}

BrickRanges ranges_of(const VectorBricks& u, std::size_t b) {
  const BrickMask& mask = u.topology.mask(b);
  const Vec3f* vectors = u.vectors.brick_or_zero(b);
  Range4 parts[8];
  for (int x = 0; x < kBrickDim; ++x) {
    for (int y = 0; y < kBrickDim; ++y) {
      Range4 row;
      for (unsigned bits = unsigned(mask[x] >> (8 * y)) & 0xff; bits != 0; bits &= bits - 1) {
        const int z = __builtin_ctz(bits);
        const Vec3f& v = vectors[64 * x + 8 * y + z];
        if (!is_within_limits(v)) refuse(u.topology.origin(b) + Vec3i(x, y, z));
        const Float4 v4 = {v.x, v.y, v.z, 0};
        row.add(v4);
        if (z > 0) continue;
        for (int n = 1; n < 8; n += 2) {
          if ((x == 0 || !(n & 4)) && (y == 0 || !(n & 2))) parts[n].add(v4);
        }
      }
      for (int n = 0; n < 8; n += 2) {
        if ((x == 0 || !(n & 4)) && (y == 0 || !(n & 2))) parts[n].add(row);
      }
    }
  }
  BrickRanges ranges;
  for (int n = 0; n < 8; ++n) ranges[n] = parts[n].range();
  return ranges;
}

}  // namespace

void DisplacementRanges::update(const VectorBricks& u, const std::vector<std::int32_t>& bricks) {
  m_slots.resize(u.topology.brick_count(), -1);
  std::vector<std::int32_t> looked_at;
  for (const std::int32_t b : bricks) {
    std::int32_t& slot = m_slots[std::size_t(b)];
    if (slot < 0 && u.vectors.brick(std::size_t(b)) == nullptr) continue;
    if (slot < 0) {
      slot = std::int32_t(m_ranges.size());
      m_ranges.emplace_back();
    }
    looked_at.push_back(b);
  }
  parallel_for(looked_at.size(), [&](std::size_t n) {
    const auto b = std::size_t(looked_at[n]);
    m_ranges[std::size_t(m_slots[b])] = ranges_of(u, b);
  });
}

VectorRange DisplacementRanges::range(const BrickTopology& bricks, std::int32_t b, int n) const {
  const std::int32_t slot = m_slots[std::size_t(b)];
  if (slot >= 0) return m_ranges[std::size_t(slot)][std::size_t(n)];
  if (!has_lowest(bricks.mask(std::size_t(b)), n)) return {};
  return {Vec3f(0), Vec3f(0)};
}

/// How far the displacements of a brick may be exceeded where its cells go on beyond the border of
/// the volume, by half their length along each axis of it.
Vec3f DisplacementRanges::beyond_border(const Vec3i& origin, const VectorRange& moves) const {
  float part = 0.5f;  // 2^m / 2 along m axes: a trilinear cell has 2^m times its range there
  for (int a = 0; a < 3; ++a) {
    if (is_at_lower_border(origin, a) || is_at_upper_border(origin, a)) part *= 2;
  }
  return (moves.hi - moves.lo) * (part - 0.5f);
}

bool DisplacementRanges::is_at_lower_border(const Vec3i& origin, int axis) const {
  return origin[axis] == 0;
}

bool DisplacementRanges::is_at_upper_border(const Vec3i& origin, int axis) const {
  const int last_cell = m_dims[axis] - 2 - origin[axis];
  return last_cell >= 0 && last_cell < kBrickDim;
}

IndexBox DisplacementRanges::reach(const BrickTopology& bricks, std::size_t b) const {
  VectorRange moved, moves;
  for (int n = 0; n < 8; ++n) {
    const std::int32_t upper = upper_brick(bricks, b, n);
    if (upper < 0) continue;
    const VectorRange at_corner = range(bricks, upper, n);
    if (at_corner.empty()) continue;
    for (int a = 0; a < 3; ++a) {
      const bool is_upper = (n >> (2 - a)) & 1;
      moves.lo[a] = std::min(moves.lo[a], at_corner.lo[a]);
      moves.hi[a] = std::max(moves.hi[a], at_corner.hi[a]);
      moved.lo[a] = std::min(moved.lo[a], at_corner.lo[a] + (is_upper ? kBrickDim : 0));
      moved.hi[a] = std::max(moved.hi[a], at_corner.hi[a] + (is_upper ? kBrickDim : kBrickDim - 1));
    }
  }
  IndexBox reach;
  if (moved.empty()) return reach;
  const Vec3i& origin = bricks.origin(b);
  const Vec3f beyond = beyond_border(origin, moves);
  for (int a = 0; a < 3; ++a) {
    const float half = float(kBeyondBorder);
    const float lo = moved.lo[a] - beyond[a] - (is_at_lower_border(origin, a) ? half : 0);
    const float hi = moved.hi[a] + beyond[a] + (is_at_upper_border(origin, a) ? half : 0);
    // Room for the rounding of a deformed corner.
    const float slack = 1e-4f + 1e-6f * std::max(std::abs(lo), std::abs(hi));
    reach.lo[a] = origin[a] + int(std::ceil(lo - slack));
    reach.hi[a] = origin[a] + int(std::floor(hi + slack));
  }
  return reach;
}

bool DisplacementRanges::is_still(const BrickTopology& bricks, std::size_t b) const {
  for (int n = 0; n < 8; ++n) {
    const std::int32_t upper = upper_brick(bricks, b, n);
    if (upper >= 0 && !range(bricks, upper, n).is_zero()) return false;
  }
  return true;
}

std::size_t DisplacementRanges::bytes() const {
  return m_slots.capacity() * sizeof(std::int32_t) + m_ranges.capacity() * sizeof(BrickRanges);
}

std::vector<std::int32_t> bricks_that_move(const VectorBricks& u) {
  std::vector<std::int32_t> stored;
  for (std::size_t b = 0; b < u.topology.brick_count(); ++b) {
    if (u.vectors.brick(b) != nullptr) stored.push_back(std::int32_t(b));
  }
  return with_lower_neighbours(u.topology, stored);
}

}  // namespace supple
