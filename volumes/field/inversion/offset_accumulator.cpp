#include "volumes/field/inversion/offset_accumulator.h"

#include <algorithm>
#include <tuple>

#include "volumes/base/parallel.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

double length_squared(const Vec3f& o) {
  return double(o.x) * o.x + double(o.y) * o.y + double(o.z) * o.z;
}

bool is_better(const Vec3f& a, const Vec3f& b) {
  const double length_a = length_squared(a), length_b = length_squared(b);
  if (length_a != length_b) return length_a < length_b;
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

/// A table to find bricks by; which voxels are active is kept beside it.
BrickTopology brick_table(std::vector<Vec3i> origins) {
  std::vector<BrickMask> masks(origins.size(), BrickMask{1});
  return {std::move(origins), std::move(masks)};
}

/// The output bricks of a box of nodes, found once.
class OutputBox {
 public:
  OutputBox(const BrickTopology& bricks, const IndexBox& box) {
    for (int a = 0; a < 3; ++a) {
      m_lo[a] = box.lo[a] >> 3;
      m_dims[a] = (box.hi[a] >> 3) - m_lo[a] + 1;
    }
    m_found.reserve(std::size_t(m_dims.x) * m_dims.y * m_dims.z);
    // Origins ascend, as bricks are sorted by x, then y, then z.
    for (int x = 0; x < m_dims.x; ++x) {
      for (int y = 0; y < m_dims.y; ++y) {
        for (int z = 0; z < m_dims.z; ++z) {
          m_found.push_back(bricks.find((m_lo + Vec3i(x, y, z)) * kBrickDim));
        }
      }
    }
  }
  /// Number of the brick that holds a node in the box; -1 where there is none.
  std::int32_t at(const Vec3i& node) const {
    const int x = (node.x >> 3) - m_lo.x, y = (node.y >> 3) - m_lo.y, z = (node.z >> 3) - m_lo.z;
    return m_found[(std::size_t(x) * m_dims.y + y) * m_dims.z + z];
  }
  const std::vector<std::int32_t>& bricks() const { return m_found; }

 private:
  Vec3i m_lo, m_dims;
  std::vector<std::int32_t> m_found;
};

}  // namespace

OffsetAccumulator::OffsetAccumulator(std::vector<Vec3i> origins)
    : m_bricks(brick_table(std::move(origins))),
      m_vectors(m_bricks.brick_count()),
      m_taken(m_bricks.brick_count()),
      m_losers(m_bricks.brick_count()),
      m_locks(m_bricks.brick_count()) {}

bool OffsetAccumulator::has_taken(std::int32_t b, int offset, Content content) const {
  const Taken& taken = m_taken[b];
  return mask_test(content == Content::tissue    ? taken.tissue
                   : content == Content::surface ? taken.surface
                                                 : taken.any,
                   offset);
}

/// Stores the offset of a node in a brick that this thread has locked.
inline void OffsetAccumulator::put(std::int32_t b, int offset, const Vec3f& o) {
  if (m_vectors.brick(std::size_t(b)) == nullptr) {
    if (o == Vec3f(0)) return;
    const SpinMutex::scoped_lock lock(m_storing);
    m_vectors.touch(std::size_t(b));
  }
  m_vectors.touch(std::size_t(b))[offset] = o;
}

inline void OffsetAccumulator::take(std::int32_t b, const NodeSolution& hit) {
  const int offset = brick_offset(hit.node);
  Taken& taken = m_taken[b];
  if (mask_test(taken.any, offset)) {
    const Vec3f o = m_vectors.brick_or_zero(std::size_t(b))[offset];
    const bool is_less = !has_taken(b, offset, hit.content);
    const bool is_more =
        hit.content < Content::tissue && has_taken(b, offset, Content(int(hit.content) + 1));
    const bool stays = is_more || (!is_less && !is_better(hit.o, o));
    if (hit.content != Content::air && mask_test(taken.surface, offset) && hit.o != o) {
      m_losers[b].push_back({offset, stays ? hit.o : o});
    }
    if (stays) return;
  }
  put(b, offset, hit.o);
  mask_set(taken.any, offset);
  if (hit.content >= Content::surface) mask_set(taken.surface, offset);
  if (hit.content == Content::tissue) mask_set(taken.tissue, offset);
}

void OffsetAccumulator::merge(const std::vector<NodeSolution>& hits) {
  for (const NodeSolution& hit : hits) {
    const std::int32_t b = m_bricks.find(hit.node);
    if (b < 0) continue;
    const SpinMutex::scoped_lock lock(m_locks[b]);
    take(b, hit);
  }
}

void OffsetAccumulator::merge(const IndexBox& reach, const std::vector<NodeSolution>& hits,
                              std::vector<OpenNode>& doubts) {
  const OutputBox box(m_bricks, reach);
  // All bricks of the box are locked, in ascending order, so that nobody waits in a circle.
  for (const std::int32_t b : box.bricks()) {
    if (b >= 0) m_locks[b].lock();
  }
  for (const NodeSolution& hit : hits) {
    const std::int32_t b = box.at(hit.node);
    if (b >= 0) take(b, hit);
  }
  const auto is_settled = [&](const OpenNode& doubt) {
    const std::int32_t b = box.at(doubt.node);
    return b < 0 || has_taken(b, brick_offset(doubt.node), doubt.content);
  };
  doubts.erase(std::remove_if(doubts.begin(), doubts.end(), is_settled), doubts.end());
  for (const std::int32_t b : box.bricks()) {
    if (b >= 0) m_locks[b].unlock();
  }
}

void OffsetAccumulator::merge_zeros(const Vec3i& origin, const BrickMask& cells,
                                    const CellContents& contents) {
  std::uint16_t rows[kCornerDim][kCornerDim], tissue_rows[kCornerDim][kCornerDim];
  BrickMask tissue_cells;
  for (int word = 0; word < 8; ++word) {
    tissue_cells[word] = cells[word] & contents.tissue_cells()[word];
  }
  corner_rows(cells, rows);
  corner_rows(tissue_cells, tissue_rows);
  // Corners lie in the brick and its seven upper neighbours.
  for (int n = 0; n < 8; ++n) {
    const Vec3i upper = cell_corner(n);
    Taken zeros;
    for (int x = 0; x < (upper.x ? 1 : kBrickDim); ++x) {
      for (int y = 0; y < (upper.y ? 1 : kBrickDim); ++y) {
        const Vec3i at(x + 8 * upper.x, y + 8 * upper.y, 0);
        const unsigned row = rows[at.x][at.y], tissue = tissue_rows[at.x][at.y];
        const auto bits = [&](unsigned nodes) {
          return std::uint64_t(upper.z ? nodes >> 8 : nodes & 0xff) << (8 * y);
        };
        zeros.any[x] |= bits(row);
        zeros.surface[x] |= bits(row & contents.elements(at.x, at.y));
        zeros.tissue[x] |= bits(tissue);
      }
    }
    if (mask_count(zeros.any) == 0) continue;
    const std::int32_t b = m_bricks.find(origin + upper * kBrickDim);
    if (b >= 0) merge_zero_nodes(b, zeros);
  }
}

/// No offset is shorter, so zeros give way only to what they are less than tissue to.
void OffsetAccumulator::merge_zero_nodes(std::int32_t b, const Taken& zeros) {
  const SpinMutex::scoped_lock lock(m_locks[b]);
  Taken& taken = m_taken[b];
  const bool is_stored = m_vectors.brick(std::size_t(b)) != nullptr;
  const Vec3f* vectors = m_vectors.brick_or_zero(std::size_t(b));
  for (int word = 0; word < 8; ++word) {
    const std::uint64_t yield = zeros.any[word] & ((taken.surface[word] & ~zeros.surface[word]) |
                                                   (taken.tissue[word] & ~zeros.tissue[word]));
    const std::uint64_t set = zeros.any[word] & ~yield;
    const auto for_bits = [&](std::uint64_t bits, auto&& visit) {
      for (; bits != 0; bits &= bits - 1) visit(64 * word + __builtin_ctzll(bits));
    };
    for_bits(is_stored ? taken.surface[word] & zeros.surface[word] : 0, [&](int offset) {
      if (vectors[offset] == Vec3f(0)) return;
      const bool stays = yield >> (offset & 63) & 1;
      m_losers[b].push_back({offset, stays ? Vec3f(0) : vectors[offset]});
    });
    for_bits(is_stored ? taken.any[word] & set : 0, [&](int offset) { put(b, offset, Vec3f(0)); });
    taken.any[word] |= zeros.any[word];
    taken.surface[word] |= zeros.surface[word] & set;
    taken.tissue[word] |= zeros.tissue[word] & set;
  }
}

bool OffsetAccumulator::is_reached_by(const IndexBox& reach) const {
  if (reach.empty() || m_bricks.empty()) return false;
  // The bricks are marked by their lowest voxel.
  const IndexBox& bounds = m_bricks.active_bounds();
  IndexBox box;
  for (int a = 0; a < 3; ++a) {
    box.lo[a] = std::max(reach.lo[a] & ~7, bounds.lo[a]);
    box.hi[a] = std::min(reach.hi[a], bounds.hi[a]);
  }
  for (int x = box.lo.x; x <= box.hi.x; x += kBrickDim) {
    for (int y = box.lo.y; y <= box.hi.y; y += kBrickDim) {
      for (int z = box.lo.z; z <= box.hi.z; z += kBrickDim) {
        if (m_bricks.find({x, y, z}) >= 0) return true;
      }
    }
  }
  return false;
}

bool OffsetAccumulator::holds(const Vec3i& node, Content content) {
  const std::int32_t b = m_bricks.find(node);
  if (b < 0) return false;
  const SpinMutex::scoped_lock lock(m_locks[b]);
  return has_taken(b, brick_offset(node), content);
}

BrickTopology OffsetAccumulator::overlaps() const {
  std::vector<BrickMask> of_brick(m_losers.size());
  parallel_for(m_losers.size(), [&](std::size_t b) {
    for (const Loser& loser : m_losers[b]) {
      const Vec3f& o = m_vectors.brick_or_zero(b)[loser.offset];
      if (length_squared(loser.o - o) > kSamePlace * kSamePlace) {
        mask_set(of_brick[b], loser.offset);
      }
    }
  });
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (std::size_t b = 0; b < of_brick.size(); ++b) {
    if (mask_count(of_brick[b]) == 0) continue;
    origins.push_back(m_bricks.origin(b));
    masks.push_back(of_brick[b]);
  }
  return {std::move(origins), std::move(masks)};
}

VectorBricks OffsetAccumulator::finish() {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  std::vector<std::size_t> kept;  // those with a solution
  for (std::size_t b = 0; b < m_bricks.brick_count(); ++b) {
    if (mask_count(m_taken[b].any) == 0) continue;
    origins.push_back(m_bricks.origin(b));
    masks.push_back(m_taken[b].any);
    kept.push_back(b);
  }
  m_vectors.keep_only(kept);
  return {BrickTopology(std::move(origins), std::move(masks)), std::move(m_vectors)};
}

}  // namespace supple
