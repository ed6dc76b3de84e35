#include "volumes/field/offset_accumulator.h"

#include <algorithm>
#include <tuple>

namespace supple {

namespace {

double length_squared(const Vec3f& o) {
  return double(o.x) * o.x + double(o.y) * o.y + double(o.z) * o.z;
}

bool is_better(const Vec3f& a, const Vec3f& b) {
  const double length_a = length_squared(a), length_b = length_squared(b);
  return std::tie(length_a, a.x, a.y, a.z) < std::tie(length_b, b.x, b.y, b.z);
}

/// A table to find bricks by; which voxels are active is kept beside it.
BrickTopology brick_table(std::vector<Vec3i> origins) {
  std::vector<BrickMask> masks(origins.size(), BrickMask{1});
  return {std::move(origins), std::move(masks)};
}

}  // namespace

OffsetAccumulator::OffsetAccumulator(std::vector<Vec3i> origins)
    : m_bricks(brick_table(std::move(origins))),
      m_vectors(m_bricks.brick_count() * kBrickVoxels, Vec3f(0)),
      m_valid(m_bricks.brick_count(), BrickMask{}),
      m_locks(m_bricks.brick_count()) {}

void OffsetAccumulator::merge(const std::vector<Hit>& hits) {
  std::int32_t b = -1;
  tbb::spin_mutex::scoped_lock lock;
  for (const Hit& hit : hits) {
    const Vec3i& node = hit.node;
    if (b < 0 || m_bricks.origin(b) != Vec3i(node.x & ~7, node.y & ~7, node.z & ~7)) {
      if (b >= 0) lock.release();
      b = m_bricks.find(node);
      lock.acquire(m_locks[b]);
    }
    const int offset = brick_offset(node);
    Vec3f& o = m_vectors[std::size_t(b) * kBrickVoxels + offset];
    if (mask_test(m_valid[b], offset) && !is_better(hit.o, o)) continue;
    o = hit.o;
    mask_set(m_valid[b], offset);
  }
}

void OffsetAccumulator::merge_zeros(const Vec3i& origin, const BrickMask& cells) {
  std::uint16_t rows[kCornerDim][kCornerDim];
  corner_rows(cells, rows);
  // Corners lie in the brick and its seven upper neighbours.
  for (int n = 0; n < 8; ++n) {
    const Vec3i upper(n >> 2, (n >> 1) & 1, n & 1);
    BrickMask nodes{};
    for (int x = 0; x < (upper.x ? 1 : kBrickDim); ++x) {
      for (int y = 0; y < (upper.y ? 1 : kBrickDim); ++y) {
        const unsigned row = rows[x + 8 * upper.x][y + 8 * upper.y];
        nodes[x] |= std::uint64_t(upper.z ? row >> 8 : row & 0xff) << (8 * y);
      }
    }
    if (mask_count(nodes) > 0) merge_zero_mask(m_bricks.find(origin + upper * kBrickDim), nodes);
  }
}

void OffsetAccumulator::merge_zero_mask(std::int32_t b, const BrickMask& nodes) {
  const tbb::spin_mutex::scoped_lock lock(m_locks[b]);
  BrickMask taken;
  for (int word = 0; word < 8; ++word) {
    taken[word] = m_valid[b][word] & nodes[word];
    m_valid[b][word] |= nodes[word];
  }
  for_each_active(
      taken, [&](int offset) { m_vectors[std::size_t(b) * kBrickVoxels + offset] = Vec3f(0); });
}

bool OffsetAccumulator::contains(const Vec3i& node) {
  const std::int32_t b = m_bricks.find(node);
  if (b < 0) return false;
  const tbb::spin_mutex::scoped_lock lock(m_locks[b]);
  return mask_test(m_valid[b], brick_offset(node));
}

VectorBricks OffsetAccumulator::finish() {
  std::vector<Vec3i> origins;
  for (std::size_t b = 0; b < m_bricks.brick_count(); ++b) origins.push_back(m_bricks.origin(b));
  BrickTopology topology(std::move(origins), m_valid);
  // The topology has dropped the bricks without a solution; close the gaps.
  std::size_t from = 0;
  for (std::size_t to = 0; to < topology.brick_count(); ++to, ++from) {
    while (m_bricks.origin(from) != topology.origin(to)) ++from;
    if (from == to) continue;
    std::copy_n(m_vectors.begin() + from * kBrickVoxels, kBrickVoxels,
                m_vectors.begin() + to * kBrickVoxels);
  }
  m_vectors.resize(topology.brick_count() * kBrickVoxels);
  m_vectors.shrink_to_fit();
  return {std::move(topology), std::move(m_vectors)};
}

}  // namespace supple
