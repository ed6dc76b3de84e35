#include "volumes/field/dense/smooth_extension.h"

#include <algorithm>
#include <cmath>

#include "volumes/field/ring_fill.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

constexpr int kRings = 8;
constexpr double kMaxBlocks = 4194304;

int floor_div(int a, int b) {
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}

}  // namespace

SmoothExtension::SmoothExtension(const VectorBricks& offsets) {
  m_near = fill_rings(offsets, touching_bricks(offsets.topology), kRings, RingFill::means, &m_ring);
  if (offsets.topology.empty()) return;
  average_blocks(offsets);
  spread_blocks();
}

std::size_t SmoothExtension::block_index(const Vec3i& block) const {
  return (std::size_t(block.x) * m_dims.y + block.y) * m_dims.z + block.z;
}

/// Averages the offsets in blocks that cover them, and one block more on every side.
void SmoothExtension::average_blocks(const VectorBricks& offsets) {
  const IndexBox& box = offsets.topology.active_bounds();
  for (;; m_block *= 2) {
    for (int a = 0; a < 3; ++a) {
      m_lo[a] = floor_div(box.lo[a], m_block) - 1;
      m_dims[a] = floor_div(box.hi[a], m_block) + 2 - m_lo[a];
    }
    if (double(m_dims.x) * m_dims.y * m_dims.z <= kMaxBlocks) break;
  }
  m_mean.assign(std::size_t(m_dims.x) * m_dims.y * m_dims.z, Vec3d(0));
  m_count.assign(m_mean.size(), 0);
  for (std::size_t b = 0; b < offsets.topology.brick_count(); ++b) {
    const Vec3i& origin = offsets.topology.origin(b);
    const Vec3i block(floor_div(origin.x, m_block), floor_div(origin.y, m_block),
                      floor_div(origin.z, m_block));
    const std::size_t n = block_index(block - m_lo);
    m_count[n] += mask_count(offsets.topology.mask(b));
    const Vec3f* const vectors = offsets.vectors.brick(b);
    if (vectors == nullptr) continue;
    for_each_active(offsets.topology.mask(b),
                    [&](int offset) { m_mean[n] += Vec3d(vectors[offset]); });
  }
  for (std::size_t n = 0; n < m_mean.size(); ++n) {
    if (m_count[n] > 0) m_mean[n] /= m_count[n];
  }
}

/// Breadth first, one ring of blocks at a time; each takes the mean of its known neighbours.
void SmoothExtension::spread_blocks() {
  const IndexBox box{Vec3i(0), m_dims - Vec3i(1)};
  const auto for_neighbours = [&](const Vec3i& block, auto&& visit) {
    for (int n = 0; n < 27; ++n) {
      const Vec3i q = block + Vec3i(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
      if (box.contains(q)) visit(q, block_index(q));
    }
  };
  std::vector<Vec3i> front, ring;
  std::vector<std::uint8_t> listed(m_mean.size(), 0);
  const auto list_unknown_neighbours = [&](const Vec3i& block) {
    for_neighbours(block, [&](const Vec3i& q, std::size_t n) {
      if (m_count[n] > 0 || listed[n]) return;
      listed[n] = 1;
      ring.push_back(q);
    });
  };
  for (int x = 0; x < m_dims.x; ++x) {
    for (int y = 0; y < m_dims.y; ++y) {
      for (int z = 0; z < m_dims.z; ++z) {
        if (m_count[block_index({x, y, z})] > 0) list_unknown_neighbours({x, y, z});
      }
    }
  }
  while (!ring.empty()) {
    front.swap(ring);
    ring.clear();
    for (const Vec3i& block : front) {
      Vec3d sum(0);
      int count = 0;
      for_neighbours(block, [&](const Vec3i&, std::size_t n) {
        if (m_count[n] <= 0) return;
        sum += m_mean[n];
        ++count;
      });
      m_mean[block_index(block)] = sum / double(count);
    }
    for (const Vec3i& block : front) m_count[block_index(block)] = 1;
    for (const Vec3i& block : front) list_unknown_neighbours(block);
  }
}

Vec3d SmoothExtension::coarse(const Vec3d& pos_index) const {
  Vec3i lo, hi;
  Vec3d t;
  for (int a = 0; a < 3; ++a) {
    const double last = m_dims[a] - 1;
    const double p = std::clamp((pos_index[a] + 0.5) / m_block - 0.5 - m_lo[a], 0.0, last);
    lo[a] = int(p);
    hi[a] = std::min(lo[a] + 1, m_dims[a] - 1);
    t[a] = p - lo[a];
  }
  Vec3d sum(0);
  for (int n = 0; n < 8; ++n) {
    const Vec3i block(n & 4 ? hi.x : lo.x, n & 2 ? hi.y : lo.y, n & 1 ? hi.z : lo.z);
    const double weight =
        (n & 4 ? t.x : 1 - t.x) * (n & 2 ? t.y : 1 - t.y) * (n & 1 ? t.z : 1 - t.z);
    sum += m_mean[block_index(block)] * weight;
  }
  return sum;
}

Vec3d SmoothExtension::at(const Vec3i& voxel) const {
  if (m_mean.empty()) return Vec3d(0);
  const std::int32_t b = m_near.topology.find(voxel);
  const int offset = brick_offset(voxel);
  if (b < 0 || !mask_test(m_near.topology.mask(b), offset)) return coarse(Vec3d(voxel));
  const std::size_t slot = std::size_t(b) * kBrickVoxels + offset;
  const double fade = m_ring[slot] / double(kRings + 1);
  const Vec3d near(m_near.vectors.brick_or_zero(std::size_t(b))[offset]);
  return fade == 0 ? near : near * (1 - fade) + coarse(Vec3d(voxel)) * fade;
}

Vec3d SmoothExtension::sample(const Vec3d& pos_index) const {
  if (m_mean.empty()) return Vec3d(0);
  const Vec3i lo = floor_voxel(pos_index);
  const Vec3d t = pos_index - Vec3d(lo);
  Vec3d sum(0);
  for (int n = 0; n < 8; ++n) {
    const double weight =
        (n & 4 ? t.x : 1 - t.x) * (n & 2 ? t.y : 1 - t.y) * (n & 1 ? t.z : 1 - t.z);
    if (weight > 0) sum += at(lo + cell_corner(n)) * weight;
  }
  return sum;
}

}  // namespace supple
