#include "volumes/grid/brick_topology.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <tuple>

namespace supple {

namespace {

// Positions beyond this have no voxel; it also keeps NaN away from the integer conversion.
constexpr double kMaxCoordinate = 1e9;

constexpr std::array<std::array<int, 3>, 6> kFaces = {
    {{-8, 0, 0}, {8, 0, 0}, {0, -8, 0}, {0, 8, 0}, {0, 0, -8}, {0, 0, 8}}};

int region_of(int voxel) {
  return voxel >> 7;
}
int table_offset(const Vec3i& v) {
  return (((v.x >> 3) & 15) << 8) | (((v.y >> 3) & 15) << 4) | ((v.z >> 3) & 15);
}

bool origin_less(const Vec3i& a, const Vec3i& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

bool is_empty(const BrickMask& mask) {
  return std::all_of(mask.begin(), mask.end(), [](std::uint64_t word) { return word == 0; });
}

/// Smallest box of the set voxels of one brick, in voxels of the whole.
void grow_bounds(IndexBox& bounds, const Vec3i& origin, const BrickMask& mask) {
  if (bounds.contains(origin) && bounds.contains(origin + Vec3i(kBrickDim - 1))) return;
  for_each_active(mask, [&](int offset) {
    const Vec3i p = origin + brick_local(offset);
    if (bounds.empty()) {
      bounds = {p, p};
      return;
    }
    for (int a = 0; a < 3; ++a) {
      bounds.lo[a] = std::min(bounds.lo[a], p[a]);
      bounds.hi[a] = std::max(bounds.hi[a], p[a]);
    }
  });
}

}  // namespace

int mask_count(const BrickMask& mask) {
  int count = 0;
  for (const std::uint64_t word : mask) count += __builtin_popcountll(word);
  return count;
}

BrickTopology::BrickTopology(std::vector<Vec3i> origins, std::vector<BrickMask> masks) {
  std::vector<std::size_t> order(origins.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  order.erase(
      std::remove_if(order.begin(), order.end(), [&](std::size_t b) { return is_empty(masks[b]); }),
      order.end());
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return origin_less(origins[a], origins[b]); });
  m_origins.reserve(order.size());
  m_masks.reserve(order.size());
  for (const std::size_t b : order) {
    m_origins.push_back(origins[b]);
    m_masks.push_back(masks[b]);
    m_active_count += mask_count(masks[b]);
    grow_bounds(m_active_bounds, origins[b], masks[b]);
  }
  build_lookup();
}

void BrickTopology::build_lookup() {
  if (m_origins.empty()) return;
  // Regions that the bricks span.
  Vec3i lo = m_origins.front(), hi = m_origins.front();
  for (const Vec3i& origin : m_origins) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], origin[a]);
      hi[a] = std::max(hi[a], origin[a]);
    }
  }
  for (int a = 0; a < 3; ++a) {
    m_region_lo[a] = region_of(lo[a]);
    m_region_dims[a] = region_of(hi[a]) - m_region_lo[a] + 1;
  }
  m_regions.assign(std::size_t(m_region_dims.x) * m_region_dims.y * m_region_dims.z, -1);

  // One table of 16^3 bricks per occupied region.
  for (std::size_t b = 0; b < m_origins.size(); ++b) {
    const Vec3i& o = m_origins[b];
    const std::size_t region = (std::size_t(region_of(o.x) - m_region_lo.x) * m_region_dims.y +
                                (region_of(o.y) - m_region_lo.y)) *
                                   m_region_dims.z +
                               (region_of(o.z) - m_region_lo.z);
    if (m_regions[region] < 0) {
      m_regions[region] = std::int32_t(m_tables.size());
      m_tables.emplace_back();
      m_tables.back().fill(-1);
    }
    m_tables[m_regions[region]][table_offset(o)] = std::int32_t(b);
  }

  m_neighbours.resize(m_origins.size());
  for (std::size_t b = 0; b < m_origins.size(); ++b) {
    for (int face = 0; face < 6; ++face) {
      const Vec3i step(kFaces[face][0], kFaces[face][1], kFaces[face][2]);
      m_neighbours[b][face] = find(m_origins[b] + step);
    }
  }
}

BrickLookup BrickTopology::lookup() const {
  if (m_tables.empty()) return {};
  return {m_region_lo, m_region_dims, m_regions.data(), m_tables.front().data()};
}

std::int32_t BrickTopology::find(const Vec3i& voxel) const {
  const int rx = region_of(voxel.x) - m_region_lo.x;
  const int ry = region_of(voxel.y) - m_region_lo.y;
  const int rz = region_of(voxel.z) - m_region_lo.z;
  if (unsigned(rx) >= unsigned(m_region_dims.x) || unsigned(ry) >= unsigned(m_region_dims.y) ||
      unsigned(rz) >= unsigned(m_region_dims.z)) {
    return -1;
  }
  const std::int32_t table =
      m_regions[(std::size_t(rx) * m_region_dims.y + ry) * m_region_dims.z + rz];
  return table < 0 ? -1 : m_tables[table][table_offset(voxel)];
}

std::size_t BrickTopology::bytes() const {
  return m_origins.capacity() * sizeof(Vec3i) + m_masks.capacity() * sizeof(BrickMask) +
         m_neighbours.capacity() * sizeof(m_neighbours[0]) +
         m_regions.capacity() * sizeof(std::int32_t) + m_tables.capacity() * sizeof(m_tables[0]);
}

bool touches(const BrickTopology& topology, const Vec3d& pos) {
  for (int a = 0; a < 3; ++a) {
    if (!(std::abs(pos[a]) < kMaxCoordinate)) return false;
  }
  const Vec3i lo(int(std::floor(pos.x)), int(std::floor(pos.y)), int(std::floor(pos.z)));
  const Vec3i span(pos.x > lo.x, pos.y > lo.y, pos.z > lo.z);
  for (int n = 0; n < 8; ++n) {
    const Vec3i step(n >> 2, (n >> 1) & 1, n & 1);
    if (step.x > span.x || step.y > span.y || step.z > span.z) continue;
    if (topology.is_active(lo + step)) return true;
  }
  return false;
}

}  // namespace supple
