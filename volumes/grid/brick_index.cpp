#include <algorithm>

#include "volumes/grid/brick_topology.h"

namespace supple {

namespace {

int region_of(int voxel) {
  return voxel >> 7;
}
std::size_t table_offset(const Vec3i& v) {
  return std::size_t((((v.x >> 3) & 15) << 8) | (((v.y >> 3) & 15) << 4) | ((v.z >> 3) & 15));
}

}  // namespace

BrickIndex::BrickIndex(std::vector<Vec3i> origins) : m_origins(std::move(origins)) {
  if (m_origins.empty()) return;
  Vec3i lo = m_origins.front(), hi = m_origins.front();
  for (const Vec3i& origin : m_origins) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], origin[a]);
      hi[a] = std::max(hi[a], origin[a]);
    }
  }
  span_regions(lo, hi);
  for (std::size_t b = 0; b < m_origins.size(); ++b) enter(b);
}

/// Makes room for the regions of the voxels lo … hi beside those there are.
void BrickIndex::span_regions(const Vec3i& lo, const Vec3i& hi) {
  Vec3i first, dims;
  for (int a = 0; a < 3; ++a) {
    const int old_end = m_region_lo[a] + m_region_dims[a];
    const bool is_first = m_regions.empty();
    first[a] = is_first ? region_of(lo[a]) : std::min(region_of(lo[a]), m_region_lo[a]);
    dims[a] = std::max(region_of(hi[a]) + 1, is_first ? region_of(hi[a]) + 1 : old_end) - first[a];
  }
  std::vector<std::int32_t> regions(std::size_t(dims.x) * dims.y * dims.z, -1);
  std::size_t from = 0;
  for (int x = 0; x < m_region_dims.x; ++x) {
    for (int y = 0; y < m_region_dims.y; ++y) {
      for (int z = 0; z < m_region_dims.z; ++z) {
        const Vec3i at = m_region_lo + Vec3i(x, y, z) - first;
        regions[(std::size_t(at.x) * dims.y + at.y) * dims.z + at.z] = m_regions[from++];
      }
    }
  }
  m_region_lo = first;
  m_region_dims = dims;
  m_regions = std::move(regions);
}

std::size_t BrickIndex::region_at(const Vec3i& voxel) const {
  const Vec3i at = Vec3i(region_of(voxel.x), region_of(voxel.y), region_of(voxel.z)) - m_region_lo;
  return (std::size_t(at.x) * m_region_dims.y + at.y) * m_region_dims.z + at.z;
}

void BrickIndex::enter(std::size_t b) {
  std::int32_t& table = m_regions[region_at(m_origins[b])];
  if (table < 0) {
    table = std::int32_t(m_tables.size());
    m_tables.emplace_back();
    m_tables.back().fill(-1);
  }
  m_tables[table][table_offset(m_origins[b])] = std::int32_t(b);
}

std::int32_t BrickIndex::find(const Vec3i& voxel) const {
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

std::size_t BrickIndex::add(const Vec3i& origin) {
  const std::int32_t found = find(origin);
  if (found >= 0) return std::size_t(found);
  for (int a = 0; a < 3; ++a) {
    const int region = region_of(origin[a]) - m_region_lo[a];
    if (region < 0 || region >= m_region_dims[a]) {
      span_regions(origin, origin);
      break;
    }
  }
  m_origins.push_back(origin);
  enter(m_origins.size() - 1);
  return m_origins.size() - 1;
}

BrickLookup BrickIndex::lookup() const {
  if (m_tables.empty()) return {};
  return {m_region_lo, m_region_dims, m_regions.data(), m_tables.front().data()};
}

std::size_t BrickIndex::place(std::size_t b) const {
  return std::size_t(m_regions[region_at(m_origins[b])]) * kTableSize + table_offset(m_origins[b]);
}

std::size_t BrickIndex::bytes() const {
  return m_origins.capacity() * sizeof(Vec3i) + m_regions.capacity() * sizeof(std::int32_t) +
         m_tables.capacity() * sizeof(m_tables[0]);
}

}  // namespace supple
