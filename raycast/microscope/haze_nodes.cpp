#include "raycast/microscope/haze_nodes.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

using namespace packed_offset;

constexpr std::uint32_t kField = (1u << kBits) - 1;
constexpr int kChunk = 256;  // of nodes that a task solves

/// Way in 2^-16 voxel to units of 1/32, kept within what fits.
std::uint32_t field_of(std::int32_t way) {
  constexpr int kShift = 11;
  const std::int32_t rounded = (way + (1 << (kShift - 1))) >> kShift;
  return std::uint32_t(std::clamp(rounded, 1 - kMiddle, kMiddle - 1) + kMiddle);
}

/// The same backwards.
std::uint32_t opposite(std::uint32_t packed) {
  std::uint32_t found = kKnown;
  for (int c = 0; c < 3; ++c) {
    const std::uint32_t field = packed >> (2 + kBits * c) & kField;
    found |= (2 * std::uint32_t(kMiddle) - field) << (2 + kBits * c);
  }
  return found;
}

}  // namespace

HazeNodes::HazeNodes(const Vec3i& dims, const DensityGrid& density, double largest) {
  m_tables.dims = dims;
  const std::size_t count = std::size_t(dims.x) * std::size_t(dims.y) * std::size_t(dims.z);
  m_tables.offsets.assign(count, kRest | kUnknown);
  m_tables.quads.assign(count, 0);
  m_is_marked.assign(count, 0);
  for (int c = 0; c < 3; ++c) m_tables.brick_dims[c] = (dims[c] + kBrickDim - 2) / kBrickDim;
  const Vec3i& bricks = m_tables.brick_dims;
  m_tables.bricks.assign(std::size_t(bricks.x * bricks.y * bricks.z), 0);

  const IndexBox box{Vec3i(0), dims - Vec3i(1)};
  for_each_voxel(density.bricks(), [&](const Vec3i& voxel) {
    if (!box.contains(voxel)) return;
    m_tables.offsets[m_tables.node(voxel.x, voxel.y, voxel.z)] = kRest | kKnown;
    const double part = std::clamp(double(density.at(voxel)) / largest, 0.0, 1.0);
    set_density(voxel, std::uint32_t(std::lround(255 * part)));
  });
  m_tables.ways = m_tables.offsets;
  parallel_for(m_tables.bricks.size(), [&](std::size_t b) { find_kind(b); });
}

Vec3i HazeNodes::voxel_at(std::uint32_t node) const {
  const int row = int(node) / m_tables.dims.z;
  return {row / m_tables.dims.y, row % m_tables.dims.y, int(node) % m_tables.dims.z};
}

void HazeNodes::set_density(const Vec3i& voxel, std::uint32_t density) {
  for (int n = 0; n < 4; ++n) {
    const int y = voxel.y - (n >> 1), z = voxel.z - (n & 1);
    if (y < 0 || z < 0) continue;
    std::uint32_t& quad = m_tables.quads[m_tables.node(voxel.x, y, z)];
    quad = (quad & ~(255u << (8 * n))) | density << (8 * n);
  }
}

/// Elements that went on by what can be seen, or are gone.
std::vector<HazeNodes::Change> HazeNodes::changes_of(const HazeElements& brick) const {
  std::vector<Change> list;
  const Vec3i& origin = brick.origin;
  const Vec3i& dims = m_tables.dims;
  for (int row = 0; row < kBrickVoxels; row += kBrickDim) {
    const Vec3i first = origin + brick_local(row);
    if (!IndexBox{Vec3i(0), dims - Vec3i(1)}.contains(first)) continue;
    const std::size_t node = m_tables.node(first.x, first.y, first.z);
    for (int n = 0; n < std::min(kBrickDim, dims.z - first.z); ++n) {
      const std::uint32_t before = m_tables.ways[node + std::size_t(n)];
      if ((before & kKnown) == kUnknown) continue;
      std::uint32_t now = kRest | kUnknown;
      if (mask_test(brick.left, row + n)) {
        now = kKnown;
        for (int c = 0; c < 3; ++c) {
          now |= field_of(brick.ways[std::size_t(c)][row + n]) << (2 + kBits * c);
        }
      }
      if (now != before) list.push_back({std::uint32_t(node) + std::uint32_t(n), before, now});
    }
  }
  return list;
}

/// Marks the 27 nodes around the place that an element of the source went to; those that it comes
/// to may have that as a first guess.
void HazeNodes::mark_around(std::uint32_t node, std::uint32_t way, bool starts_there) {
  const Vec3i voxel = voxel_at(node);
  const std::uint32_t guess = opposite(way);
  Vec3i lo, hi;
  for (int c = 0; c < 3; ++c) {
    const auto field = std::int32_t(way >> (2 + kBits * c) & kField);
    const int at = voxel[c] + ((field - kMiddle + 16) >> 5);
    lo[c] = std::clamp(at - 1, 0, m_tables.dims[c] - 1);
    hi[c] = std::clamp(at + 1, 0, m_tables.dims[c] - 1);
  }
  for (int x = lo.x; x <= hi.x; ++x) {
    for (int y = lo.y; y <= hi.y; ++y) {
      const std::size_t row = m_tables.node(x, y, 0);
      for (int z = lo.z; z <= hi.z; ++z) {
        const std::size_t n = row + std::size_t(z);
        if (m_is_marked[n] == 0) m_marked.push_back(std::uint32_t(n));
        m_is_marked[n] = 1;
        if (starts_there) m_tables.offsets[n] = guess;
      }
    }
  }
}

/// Finds what samples in the cells of a brick need.
void HazeNodes::find_kind(std::size_t brick) {
  const Vec3i& bricks = m_tables.brick_dims;
  const int b = int(brick);
  const Vec3i origin =
      Vec3i(b / (bricks.y * bricks.z), b / bricks.z % bricks.y, b % bricks.z) * kBrickDim;
  Vec3i hi;
  for (int c = 0; c < 3; ++c) hi[c] = std::min(origin[c] + kBrickDim + 1, m_tables.dims[c]);
  std::uint32_t any_known = 0, any_moved = 0, any_density = 0;
  for (int x = origin.x; x < hi.x; ++x) {
    for (int y = origin.y; y < hi.y; ++y) {
      const std::size_t row = m_tables.node(x, y, 0);
      for (int z = origin.z; z < hi.z; ++z) {
        const std::uint32_t packed = m_tables.offsets[row + std::size_t(z)];
        const std::uint32_t density = m_tables.quads[row + std::size_t(z)] & 255;
        any_known |= packed & kKnown;
        any_density |= density;
        // An unknown node is as one at rest where the source is void there.
        any_moved |= ((packed | kKnown) ^ (kRest | kKnown)) | ((packed & 1) == 0 ? density : 0);
      }
    }
  }
  const bool is_seen = any_known != 0 && (any_moved | any_density) != 0;
  m_tables.bricks[brick] = std::int32_t(!is_seen         ? HazeBrick::empty
                                        : any_moved != 0 ? HazeBrick::moved
                                                         : HazeBrick::resting);
}

void HazeNodes::follow(const std::vector<HazeElements>& bricks) {
  std::vector<std::vector<Change>> changes(bricks.size());
  parallel_for(bricks.size(), Grain{8}, [&](std::size_t n) { changes[n] = changes_of(bricks[n]); });
  m_marked.clear();
  for (const std::vector<Change>& list : changes) {
    for (const Change& change : list) {
      m_tables.ways[change.node] = change.now;
      mark_around(change.node, change.before, false);
      const bool is_left = (change.now & kKnown) != kUnknown;
      if (is_left) mark_around(change.node, change.now, true);
      if (!is_left) set_density(voxel_at(change.node), 0);
    }
  }
  const std::size_t chunks = (m_marked.size() + kChunk - 1) / kChunk;
  parallel_for(chunks, [&](std::size_t n) {
    const std::size_t from = n * kChunk;
    solve_offsets(m_tables, m_marked.data() + from,
                  int(std::min<std::size_t>(kChunk, m_marked.size() - from)));
  });

  const Vec3i& all = m_tables.brick_dims;
  std::vector<std::uint8_t> is_reached(m_tables.bricks.size(), 0);
  const auto reach = [&](std::uint32_t node) {
    // A node belongs to the cells on both of its sides.
    const Vec3i voxel = voxel_at(node);
    for (int n = 0; n < 8; ++n) {
      const Vec3i cell = voxel - Vec3i(n >> 2, n >> 1 & 1, n & 1);
      if (std::min({cell.x, cell.y, cell.z}) < 0) continue;
      const Vec3i b = cell / Vec3i(kBrickDim);
      if (b.x >= all.x || b.y >= all.y || b.z >= all.z) continue;
      is_reached[std::size_t((b.x * all.y + b.y) * all.z + b.z)] = 1;
    }
  };
  for (const std::uint32_t node : m_marked) {
    m_is_marked[node] = 0;
    reach(node);
  }
  for (const std::vector<Change>& list : changes) {
    for (const Change& change : list) {
      if ((change.now & kKnown) == kUnknown) reach(change.node);
    }
  }
  std::vector<std::uint32_t> reached;
  for (std::size_t b = 0; b < is_reached.size(); ++b) {
    if (is_reached[b] != 0) reached.push_back(std::uint32_t(b));
  }
  parallel_for(reached.size(), Grain{4}, [&](std::size_t n) { find_kind(reached[n]); });
}

}  // namespace supple
