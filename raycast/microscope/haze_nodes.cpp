#include "raycast/microscope/haze_nodes.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

using namespace packed_offset;

constexpr std::uint32_t kMask = (1u << kBits) - 1;
constexpr std::uint32_t kRest =
    std::uint32_t(kMiddle) << 2 | std::uint32_t(kMiddle) << 12 | std::uint32_t(kMiddle) << 22;

std::uint32_t pack(const Vec3f& offset, std::uint32_t known) {
  std::uint32_t packed = known;
  for (int c = 0; c < 3; ++c) {
    if (!(std::abs(offset[c]) <= kLargest)) return kRest | kUnknown;
    const auto value = std::uint32_t(std::lround(offset[c] / kUnit) + kMiddle);
    packed |= value << (2 + kBits * c);
  }
  return packed;
}

Vec3f unpack(std::uint32_t packed) {
  Vec3f offset;
  for (int c = 0; c < 3; ++c) {
    offset[c] = float(std::int32_t(packed >> (2 + kBits * c) & kMask) - kMiddle) * kUnit;
  }
  return offset;
}

bool is_own(std::uint32_t packed) {
  return (packed & 3) == kKnown;
}

/// Origins of these bricks and of those around them, each once.
std::vector<Vec3i> with_neighbours(const std::vector<Vec3i>& origins, int lowest, int highest) {
  std::vector<Vec3i> all;
  for (const Vec3i& origin : origins) {
    for (int x = lowest; x <= highest; ++x) {
      for (int y = lowest; y <= highest; ++y) {
        for (int z = lowest; z <= highest; ++z) all.push_back(origin + Vec3i(x, y, z) * kBrickDim);
      }
    }
  }
  std::sort(all.begin(), all.end(), voxel_less);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

template <class Visit>
void for_each_node(const Vec3i& lo, const Vec3i& hi, Visit&& visit) {
  for (int x = lo.x; x < hi.x; ++x) {
    for (int y = lo.y; y < hi.y; ++y) {
      for (int z = lo.z; z < hi.z; ++z) visit(Vec3i(x, y, z));
    }
  }
}

}  // namespace

HazeNodes::HazeNodes(const Vec3i& dims, const DensityGrid& density, double largest) {
  m_tables.dims = dims;
  const std::size_t count = std::size_t(dims.x) * std::size_t(dims.y) * std::size_t(dims.z);
  m_tables.offsets.assign(count, kRest | kUnknown);
  m_tables.quads.assign(count, 0);
  for (int c = 0; c < 3; ++c) m_tables.brick_dims[c] = (dims[c] + kBrickDim - 2) / kBrickDim;
  const Vec3i& bricks = m_tables.brick_dims;
  m_tables.bricks.assign(std::size_t(bricks.x * bricks.y * bricks.z), 0);

  m_eighths = (dims.z + kBrickDim - 1) / kBrickDim;
  m_own.assign(std::size_t(dims.x) * std::size_t(dims.y) * std::size_t(m_eighths), 0);
  const IndexBox box{Vec3i(0), dims - Vec3i(1)};
  for_each_voxel(density.bricks(), [&](const Vec3i& voxel) {
    if (!box.contains(voxel)) return;
    m_tables.offsets[m_tables.node(voxel.x, voxel.y, voxel.z)] = kRest | kKnown;
    own_row(voxel.x, voxel.y, voxel.z / kBrickDim) |= std::uint8_t(1 << voxel.z % kBrickDim);
    const double part = std::clamp(double(density.at(voxel)) / largest, 0.0, 1.0);
    set_density(voxel, std::uint32_t(std::lround(255 * part)));
  });
  std::vector<Vec3i> origins;
  for_each_node(Vec3i(0), bricks, [&](const Vec3i& n) { origins.push_back(n * kBrickDim); });
  parallel_for(origins.size(), [&](std::size_t n) { extend_offsets(origins[n]); });
  parallel_for(origins.size(), [&](std::size_t n) { find_kind(origins[n]); });
}

HazeNodes::Range HazeNodes::nodes_of(const Vec3i& origin) const {
  Range range{origin, origin + Vec3i(kBrickDim)};
  for (int c = 0; c < 3; ++c) {
    range.lo[c] = std::clamp(range.lo[c], 0, m_tables.dims[c]);
    range.hi[c] = std::clamp(range.hi[c], 0, m_tables.dims[c]);
  }
  return range;
}

std::uint8_t& HazeNodes::own_row(int x, int y, int z_eighth) {
  return m_own[(std::size_t(x) * std::size_t(m_tables.dims.y) + std::size_t(y)) *
                   std::size_t(m_eighths) +
               std::size_t(z_eighth)];
}

/// The same, 0 outside of the box.
std::uint8_t HazeNodes::own_in(int x, int y, int z_eighth) const {
  const Vec3i last(m_tables.dims.x - 1, m_tables.dims.y - 1, m_eighths - 1);
  if (!IndexBox{Vec3i(0), last}.contains({x, y, z_eighth})) return 0;
  return m_own[(std::size_t(x) * std::size_t(m_tables.dims.y) + std::size_t(y)) *
                   std::size_t(m_eighths) +
               std::size_t(z_eighth)];
}

void HazeNodes::set_density(const Vec3i& voxel, std::uint32_t density) {
  for (int n = 0; n < 4; ++n) {
    const int y = voxel.y - (n >> 1), z = voxel.z - (n & 1);
    if (y < 0 || z < 0) continue;
    std::uint32_t& quad = m_tables.quads[m_tables.node(voxel.x, y, z)];
    quad = (quad & ~(255u << (8 * n))) | density << (8 * n);
  }
}

void HazeNodes::take_offsets(const Vec3i& origin, const VectorBrickView& view) {
  const Range range = nodes_of(origin);
  if (range.lo.z >= range.hi.z) return;
  for_each_node(range.lo, {range.hi.x, range.hi.y, range.lo.z + 1}, [&](const Vec3i& row) {
    std::uint8_t own = 0;
    for (int z = row.z; z < range.hi.z; ++z) {
      const int offset = brick_offset({row.x, row.y, z});
      const bool is_known = view.mask != nullptr && mask_test(*view.mask, offset);
      std::uint32_t& packed = m_tables.offsets[m_tables.node(row.x, row.y, z)];
      packed = is_known ? pack(view.vectors[offset], kKnown) : kRest | kUnknown;
      if (is_own(packed)) own |= std::uint8_t(1 << z % kBrickDim);
    }
    own_row(row.x, row.y, row.z / kBrickDim) = own;
  });
}

/// Mean of the known offsets around a node.
std::uint32_t HazeNodes::mean_around(const Vec3i& node) const {
  Vec3f sum(0);
  int count = 0;
  for (int n = 0; n < 27; ++n) {
    const Vec3i at = node + Vec3i(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
    if (!IndexBox{Vec3i(0), m_tables.dims - Vec3i(1)}.contains(at)) continue;
    const std::uint32_t packed = m_tables.offsets[m_tables.node(at.x, at.y, at.z)];
    if (!is_own(packed)) continue;
    sum += unpack(packed);
    ++count;
  }
  return count == 0 ? kRest | kUnknown : pack(sum / float(count), kExtended);
}

/// Gives nodes without an offset that of the known ones around them, of which none is changed.
void HazeNodes::extend_offsets(const Vec3i& origin) {
  const Range range = nodes_of(origin);
  if (range.lo.z >= range.hi.z) return;
  const int eighth = range.lo.z / kBrickDim;
  for_each_node(range.lo, {range.hi.x, range.hi.y, range.lo.z + 1}, [&](const Vec3i& row) {
    const std::uint32_t own = own_in(row.x, row.y, eighth);
    std::uint32_t near = 0;
    for (int n = 0; n < 9; ++n) {
      const int x = row.x + n / 3 - 1, y = row.y + n % 3 - 1;
      const std::uint32_t here = own_in(x, y, eighth);
      near |= here | here << 1 | here >> 1 | std::uint32_t(own_in(x, y, eighth - 1)) >> 7 |
              (own_in(x, y, eighth + 1) & 1u) << 7;
    }
    for (int z = row.z; z < range.hi.z; ++z) {
      const std::uint32_t bit = 1u << z % kBrickDim;
      if ((own & bit) != 0) continue;
      m_tables.offsets[m_tables.node(row.x, row.y, z)] =
          (near & bit) != 0 ? mean_around({row.x, row.y, z}) : kRest | kUnknown;
    }
  });
}

/// Finds what samples in the cells of a brick need.
void HazeNodes::find_kind(const Vec3i& origin) {
  Vec3i hi;
  for (int c = 0; c < 3; ++c) {
    if (origin[c] < 0 || origin[c] >= m_tables.dims[c] - 1) return;
    hi[c] = std::min(origin[c] + kBrickDim + 1, m_tables.dims[c]);
  }
  bool any_known = false, any_moved = false, any_density = false;
  for_each_node(origin, hi, [&](const Vec3i& node) {
    const std::size_t n = m_tables.node(node.x, node.y, node.z);
    const std::uint32_t packed = m_tables.offsets[n], density = m_tables.quads[n] & 255;
    const bool is_known = (packed & 3) != kUnknown;
    any_known = any_known || is_known;
    any_density = any_density || density != 0;
    // An unknown node is as one at rest where the source is void there.
    any_moved = any_moved || (packed & ~3u) != kRest || (!is_known && density != 0);
  });
  const bool is_seen = any_known && (any_moved || any_density);
  const HazeBrick kind = !is_seen    ? HazeBrick::empty
                         : any_moved ? HazeBrick::moved
                                     : HazeBrick::resting;
  const Vec3i b = origin / Vec3i(kBrickDim);
  const Vec3i& bricks = m_tables.brick_dims;
  m_tables.bricks[std::size_t((b.x * bricks.y + b.y) * bricks.z + b.z)] = std::int32_t(kind);
}

void HazeNodes::follow(const std::vector<Vec3i>& origins, const VectorBrickFinder& offsets) {
  parallel_for(origins.size(), Grain{4},
               [&](std::size_t n) { take_offsets(origins[n], offsets(origins[n])); });
  const std::vector<Vec3i> around = with_neighbours(origins, -1, 1);
  parallel_for(around.size(), Grain{4}, [&](std::size_t n) { extend_offsets(around[n]); });
  const std::vector<Vec3i> reached = with_neighbours(origins, -2, 1);
  parallel_for(reached.size(), Grain{4}, [&](std::size_t n) { find_kind(reached[n]); });
}

void HazeNodes::remove(const std::vector<Vec3i>& voxels) {
  const IndexBox box{Vec3i(0), m_tables.dims - Vec3i(1)};
  std::vector<Vec3i> origins;
  for (const Vec3i& voxel : voxels) {
    if (!box.contains(voxel)) continue;
    set_density(voxel, 0);
    origins.emplace_back(voxel.x & ~7, voxel.y & ~7, voxel.z & ~7);
  }
  for (const Vec3i& origin : with_neighbours(origins, -1, 0)) find_kind(origin);
}

}  // namespace supple
