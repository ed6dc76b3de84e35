#include "lib/fem/voxel/thin_parts.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>

#include "lib/fem/voxel/corner_sets.h"
#include "volumes/grid/brick_topology.h"
#include "volumes/grid/mask_steps.h"

namespace supple {

namespace {

constexpr int kThinWidth = 6;  // elements
/// Pieces lie in cubes of 2^2 elements' width or, where they are too many to factorise, of 2^9.
constexpr int kCubeBits = 2, kMostCubeBits = 9;
constexpr std::size_t kMostPieces = 3000, kNodesOfPiece = 200;
/// Pieces of fewer nodes join a neighbour or are none, since some of their motions would be none.
constexpr std::size_t kLeastNodes = 8;

/// Calls step(mask, that of the brick on this side of it, axis, new mask) for all bricks.
template <class Step>
void step_along(const BrickTopology& bricks, std::vector<BrickMask>& masks, int axis, int side,
                Step&& step) {
  static constexpr BrickMask kNone{};
  std::vector<BrickMask> next = masks;
  for (std::size_t b = 0; b < masks.size(); ++b) {
    const std::int32_t beside = bricks.neighbour(b, 2 * axis + side);
    step(masks[b], beside < 0 ? kNone : masks[std::size_t(beside)], axis, next[b]);
  }
  masks.swap(next);
}

/// Takes away all cubes of kThinWidth^3 set voxels: what is left is thin.
void keep_thin(const BrickTopology& bricks, std::vector<BrickMask>& masks) {
  std::vector<BrickMask> cubes = masks;
  for (int n = 0; n < 3 * (kThinWidth - 1); ++n) {
    step_along(bricks, cubes, n % 3, 1,
               [](const BrickMask& mask, const BrickMask& above, int axis, BrickMask& out) {
                 keep(shifted_down(mask, above, axis), out);
               });
  }
  for (int n = 0; n < 3 * (kThinWidth - 1); ++n) {
    step_along(bricks, cubes, n % 3, 0,
               [](const BrickMask& mask, const BrickMask& below, int axis, BrickMask& out) {
                 add(shifted_up(mask, below, axis), out);
               });
  }
  for (std::size_t b = 0; b < masks.size(); ++b) {
    for (std::size_t word = 0; word < masks[b].size(); ++word) masks[b][word] &= ~cubes[b][word];
  }
}

/// The elements of thin parts, block by block.
std::vector<BrickMask> thin_elements(const HexMesh& voxels) {
  std::vector<BrickMask> masks(voxels.block_count());
  for (std::size_t b = 0; b < voxels.block_count(); ++b) {
    for (std::int32_t e = voxels.element_begin[b]; e < voxels.element_begin[b + 1]; ++e) {
      mask_set(masks[b], voxels.offset[e]);
    }
  }
  keep_thin(BrickTopology(voxels.origin, masks), masks);
  return masks;
}

/// Pieces that are found block by block, and joined; none where they stay too many, as islands do.
class PieceSets {
 public:
  PieceSets(const HexMesh& voxels, const std::vector<BrickMask>& thin, const HeldBits& held,
            const Progress* progress)
      : m_owner(std::size_t(voxels.node_count()), -1) {
    for (std::size_t b = 0; b < voxels.block_count(); ++b) {
      if (thin[b] == BrickMask{}) continue;
      poll(progress);
      find(voxels, thin[b], held, b);
    }
    m_sets.emplace(m_place.size());
    m_nodes.resize(m_place.size());
    for (const std::int32_t piece : m_owner) {
      if (piece >= 0) ++m_nodes[std::size_t(piece)];
    }
    join([&](std::uint32_t a, std::uint32_t b) {
      return std::min(m_nodes[m_sets->find(a)], m_nodes[m_sets->find(b)]) < kLeastNodes;
    });
    const std::size_t most = std::min(kMostPieces, m_owner.size() / kNodesOfPiece);
    for (int shift = kCubeBits + 1; number() > most && shift <= kMostCubeBits; ++shift) {
      join([&](std::uint32_t a, std::uint32_t b) {
        return shifted(m_place[a], shift) == shifted(m_place[b], shift);
      });
    }
    if (m_count <= most) return;
    m_count = 0;
    std::fill(m_owner.begin(), m_owner.end(), -1);
  }

  std::size_t count() const { return m_count; }
  /// Takes the number of each node's piece, or -1.
  std::vector<std::int32_t> take_numbers() {
    for (std::int32_t& owner : m_owner) {
      if (owner >= 0) owner = m_number[m_sets->find(std::uint32_t(owner))];
    }
    return std::move(m_owner);
  }

 private:
  static Vec3i shifted(const Vec3i& place, int shift) {
    return {place.x >> shift, place.y >> shift, place.z >> shift};
  }

  /// Pieces of one block: elements of one cube that share nodes.
  void find(const HexMesh& voxels, const BrickMask& thin, const HeldBits& held, std::size_t block) {
    std::map<int, std::vector<std::int32_t>> of_cubes;
    for (std::int32_t e = voxels.element_begin[block]; e < voxels.element_begin[block + 1]; ++e) {
      if (!mask_test(thin, voxels.offset[e])) continue;
      if (held_corners(voxels.corners_in(block, e), held) == kAllCornersHeld) continue;
      of_cubes[brick_offset(shifted(brick_local(voxels.offset[e]), kCubeBits))].push_back(e);
    }
    for (const auto& [cube, elements] : of_cubes) {
      std::map<NodeIndex, std::uint32_t> first;  // the first element that has a node
      CornerSets joined(elements.size());
      for (std::uint32_t n = 0; n < elements.size(); ++n) {
        for (const NodeIndex node : voxels.corners_in(block, elements[n])) {
          joined.join(first.try_emplace(node, n).first->second, n);
        }
      }
      std::map<std::uint32_t, std::int32_t> piece_of;
      for (const auto& [node, n] : first) {
        if (held[std::size_t(node)] == kAllHeld) continue;
        const auto [piece, is_new] =
            piece_of.try_emplace(joined.find(n), std::int32_t(m_place.size()));
        if (is_new) {
          m_place.push_back(voxels.origin[block] + brick_local(voxels.offset[elements[n]]));
        }
        std::int32_t& owner = m_owner[std::size_t(node)];
        if (owner < 0) {
          owner = piece->second;
        } else {
          m_links.push_back({owner, piece->second});
        }
      }
    }
  }

  /// Joins the pieces that share a node and for which `belong(a, b)`.
  template <class Belong>
  void join(Belong&& belong) {
    for (const auto& [one, other] : m_links) {
      const auto a = std::uint32_t(one), b = std::uint32_t(other);
      const std::uint32_t from = m_sets->find(a), to = m_sets->find(b);
      if (from == to || !belong(a, b)) continue;
      m_sets->join(from, to);
      m_nodes[m_sets->find(from)] = m_nodes[from] + m_nodes[to];
    }
  }
  std::size_t number() {
    m_count = 0;
    m_number.assign(m_place.size(), -1);
    for (std::uint32_t n = 0; n < m_number.size(); ++n) {
      if (m_sets->find(n) == n && m_nodes[n] >= kLeastNodes) m_number[n] = std::int32_t(m_count++);
    }
    return m_count;
  }

  std::vector<std::int32_t> m_owner;                           // per node
  std::vector<Vec3i> m_place;                                  // per piece a cell of it
  std::vector<std::pair<std::int32_t, std::int32_t>> m_links;  // pieces that share a node
  std::optional<CornerSets> m_sets;
  std::vector<std::size_t> m_nodes;    // of each set
  std::vector<std::int32_t> m_number;  // of each set
  std::size_t m_count = 0;
};

}  // namespace

ThinParts thin_parts(const HexMesh& voxels, const HeldBits& held, const Progress* progress) {
  PieceSets sets(voxels, thin_elements(voxels), held, progress);
  ThinParts parts;
  parts.count = sets.count();
  parts.piece_of = sets.take_numbers();
  return parts;
}

}  // namespace supple
