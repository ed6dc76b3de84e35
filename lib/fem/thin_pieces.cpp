#include "lib/fem/thin_pieces.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <tbb/parallel_for.h>

#include "lib/fem/corner_sets.h"
#include "volumes/grid/mask_steps.h"

namespace supple {

namespace {

constexpr int kThinWidth = 6;  // elements
/// Pieces lie in blocks of 4^3 elements or, where they are too many to factorise, larger ones.
constexpr int kCubeBits = 2, kMostCubeBits = 10;
constexpr std::size_t kMostPieces = 4000;
constexpr std::uint8_t kAllHeld = 7;
/// Those of fewer nodes join a neighbour, since some of their motions would be none.
constexpr std::size_t kLeastNodes = 8;

using Matrix6 = std::array<std::array<double, 6>, 6>;
using PiecePair = std::pair<std::int32_t, std::int32_t>;

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
std::vector<BrickMask> thin_parts(const HexMesh& voxels) {
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
  PieceSets(const HexMesh& voxels, const std::vector<BrickMask>& thin, const HeldBits& held)
      : m_owner(std::size_t(voxels.node_count()), -1) {
    for (std::size_t b = 0; b < voxels.block_count(); ++b) find(voxels, thin[b], held, b);
    m_sets.emplace(m_place.size());
    m_nodes.resize(m_place.size());
    for (const std::int32_t piece : m_owner) {
      if (piece >= 0) ++m_nodes[std::size_t(piece)];
    }
    join([&](std::uint32_t a, std::uint32_t b) {
      return std::min(m_nodes[m_sets->find(a)], m_nodes[m_sets->find(b)]) < kLeastNodes;
    });
    for (int shift = kCubeBits + 1; number() > kMostPieces && shift < kMostCubeBits; ++shift) {
      join([&](std::uint32_t a, std::uint32_t b) {
        return shifted(m_place[a], shift) == shifted(m_place[b], shift);
      });
    }
    if (m_count <= kMostPieces) return;
    m_count = 0;
    std::fill(m_owner.begin(), m_owner.end(), -1);
  }

  std::size_t count() const { return m_count; }
  /// Per node the number of its piece, or -1.
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

  /// Those of one block: elements of one cube of 2^kCubeBits that share nodes.
  void find(const HexMesh& voxels, const BrickMask& thin, const HeldBits& held, std::size_t block) {
    std::map<int, std::vector<std::int32_t>> of_cubes;
    for (std::int32_t e = voxels.element_begin[block]; e < voxels.element_begin[block + 1]; ++e) {
      if (!mask_test(thin, voxels.offset[e])) continue;
      of_cubes[brick_offset(shifted(brick_local(voxels.offset[e]), kCubeBits))].push_back(e);
    }
    for (const auto& [cube, elements] : of_cubes) {
      std::map<NodeIndex, std::uint32_t> first;  // the first element that has a node
      CornerSets sets(elements.size());
      for (std::uint32_t n = 0; n < elements.size(); ++n) {
        for (const NodeIndex node : voxels.corners_in(block, elements[n])) {
          sets.join(first.try_emplace(node, n).first->second, n);
        }
      }
      std::map<std::uint32_t, std::int32_t> piece_of;
      for (const auto& [node, n] : first) {
        if (held[std::size_t(node)] == kAllHeld) continue;
        const auto [piece, is_new] =
            piece_of.try_emplace(sets.find(n), std::int32_t(m_place.size()));
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
      if (m_sets->find(n) == n && m_nodes[n] > 0) m_number[n] = std::int32_t(m_count++);
    }
    return m_count;
  }

  std::vector<std::int32_t> m_owner;  // per node
  std::vector<Vec3i> m_place;         // per piece a cell of it
  std::vector<PiecePair> m_links;     // pieces that share a node
  std::optional<CornerSets> m_sets;
  std::vector<std::size_t> m_nodes;    // of each set
  std::vector<std::int32_t> m_number;  // of each set
  std::size_t m_count = 0;
};

/// The displacement of a node by a motion of its piece.
Vec3f moved_by(const float* motion, const Vec3f& arm) {
  return Vec3f(motion[0], motion[1], motion[2]) + Vec3f(motion[3], motion[4], motion[5]).cross(arm);
}

/// The six motions of a piece as one of its nodes is displaced.
using NodeMotions = std::array<Vec3d, 6>;
NodeMotions motions_of(const Vec3f& arm, std::uint8_t held) {
  NodeMotions motions;
  for (std::size_t n = 0; n < 6; ++n) {
    float unit[6] = {};
    unit[n] = 1;
    motions[n] = Vec3d(moved_by(unit, arm));
    for (int a = 0; a < 3; ++a) {
      if ((held >> a & 1) != 0) motions[n][a] = 0;
    }
  }
  return motions;
}

/// Adds Z^T K Z of one element to the sums of pairs of pieces.
void add_element(const Matrix24& k, const std::array<std::int32_t, 8>& pieces,
                 const std::array<NodeMotions, 8>& z, std::map<PiecePair, Matrix6>& sums) {
  std::array<std::int32_t, 8> distinct = pieces;
  std::sort(distinct.begin(), distinct.end());
  const auto end = std::unique(distinct.begin(), distinct.end());
  for (auto column = distinct.begin(); column != end; ++column) {
    if (*column < 0) continue;
    std::array<std::array<double, 6>, 24> forces{};  // K Z
    for (int c = 0; c < 8; ++c) {
      if (pieces[c] != *column) continue;
      for (int n = 0; n < 24; ++n) {
        for (int motion = 0; motion < 6; ++motion) {
          for (int a = 0; a < 3; ++a) forces[n][motion] += k[n][3 * c + a] * z[c][motion][a];
        }
      }
    }
    for (int c = 0; c < 8; ++c) {
      if (pieces[c] < 0) continue;
      Matrix6& sum = sums[{pieces[c], *column}];
      for (int row = 0; row < 6; ++row) {
        for (int a = 0; a < 3; ++a) {
          for (int motion = 0; motion < 6; ++motion) {
            sum[row][motion] += z[c][row][a] * forces[3 * c + a][motion];
          }
        }
      }
    }
  }
}

/// Rows 2 n and 2 n + 1 are translation and turn of piece n.
BlockMatrix<double> as_blocks(const std::map<PiecePair, Matrix6>& sums, std::size_t pieces) {
  BlockMatrix<double> out;
  out.row_begin.push_back(0);
  auto next = sums.begin();
  for (std::int32_t piece = 0; piece < std::int32_t(pieces); ++piece) {
    const auto first = next;
    while (next != sums.end() && next->first.first == piece) ++next;
    for (int row = 0; row < 6; row += 3) {
      for (auto of = first; of != next; ++of) {
        for (int column = 0; column < 6; column += 3) {
          out.column.push_back(2 * of->first.second + column / 3);
          auto& block = out.blocks.emplace_back();
          for (int ab = 0; ab < 9; ++ab) {
            block.value[ab] = of->second[row + ab % 3][column + ab / 3];
          }
        }
      }
      out.row_begin.push_back(std::int64_t(out.blocks.size()));
    }
  }
  return out;
}

template <class Visit>
void for_pieces(std::size_t count, Visit&& visit) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 16),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t n = range.begin(); n < range.end(); ++n) visit(n);
                    });
}

}  // namespace

ThinPieces::ThinPieces(const HexMesh& voxels, const VoxelMaterial& material, const HeldBits& held) {
  const PieceOfNode piece_of = gather(voxels, held);
  if (count() == 0) return;
  find_blocks(voxels, piece_of);
  m_solver.emplace(stiffness(voxels, material, piece_of));
  m_forces.resize(6 * count());
  m_motions.resize(6 * count());
}

ThinPieces::PieceOfNode ThinPieces::gather(const HexMesh& voxels, const HeldBits& held) {
  PieceSets sets(voxels, thin_parts(voxels), held);
  m_begin.assign(sets.count() + 1, 0);
  PieceOfNode piece_of = sets.take_numbers();
  for (const std::int32_t piece : piece_of) {
    if (piece >= 0) ++m_begin[std::size_t(piece) + 1];
  }
  for (std::size_t n = 0; n < count(); ++n) m_begin[n + 1] += m_begin[n];
  m_members.resize(m_begin.back());
  std::vector<std::size_t> next(m_begin.begin(), m_begin.end() - 1);
  // Of the first element that has it, each node takes its place.
  std::vector<bool> is_placed(piece_of.size(), false);
  for (std::size_t b = 0; b < voxels.block_count(); ++b) {
    for (std::int32_t e = voxels.element_begin[b]; e < voxels.element_begin[b + 1]; ++e) {
      const Corners corners = voxels.corners_in(b, e);
      for (int c = 0; c < 8; ++c) {
        const auto node = std::size_t(corners[c]);
        if (piece_of[node] < 0 || is_placed[node]) continue;
        is_placed[node] = true;
        m_members[next[std::size_t(piece_of[node])]++] = {
            corners[c], Vec3f(corner_position(voxels, std::int32_t(b), voxels.offset[e], c)),
            held[node]};
      }
    }
  }
  const auto& axes = voxels.geometry.axes_mm();
  const double width = kBrickDim * std::cbrt(std::abs(axes[0].cross(axes[1]).dot(axes[2])));
  for (std::size_t piece = 0; piece < count(); ++piece) {
    Vec3d sum(0.0);
    for (std::size_t n = m_begin[piece]; n < m_begin[piece + 1]; ++n)
      sum += Vec3d(m_members[n].arm);
    const Vec3d middle = sum / double(m_begin[piece + 1] - m_begin[piece]);
    for (std::size_t n = m_begin[piece]; n < m_begin[piece + 1]; ++n) {
      m_members[n].arm = Vec3f((Vec3d(m_members[n].arm) - middle) / width);
    }
  }
  return piece_of;
}

void ThinPieces::find_blocks(const HexMesh& voxels, const PieceOfNode& piece_of) {
  for (std::size_t colour = 0; colour < m_blocks.size(); ++colour) {
    for (const std::int32_t block : voxels.of_colour[colour]) {
      const auto b = std::size_t(block);
      const NodeIndex* nodes = voxels.tables.nodes(b);
      const bool has_piece = std::any_of(nodes, nodes + voxels.tables.size(b), [&](NodeIndex node) {
        return node >= 0 && piece_of[std::size_t(node)] >= 0;
      });
      if (has_piece) m_blocks[colour].push_back(block);
    }
  }
}

BlockMatrix<double> ThinPieces::stiffness(const HexMesh& voxels, const VoxelMaterial& material,
                                          const PieceOfNode& piece_of) const {
  std::vector<const Member*> member_of(piece_of.size());
  for (const Member& member : m_members) member_of[std::size_t(member.node)] = &member;
  std::vector<std::map<PiecePair, Matrix6>> of_blocks(voxels.block_count());
  const auto add_block = [&](std::size_t b) {
    for (std::int32_t e = voxels.element_begin[b]; e < voxels.element_begin[b + 1]; ++e) {
      const Corners corners = voxels.corners_in(b, e);
      const std::uint8_t of = material.classes[e];
      std::array<std::int32_t, 8> pieces;
      bool moves_as_one = material.moduli.inertia[of] == 0;
      for (int c = 0; c < 8; ++c) {
        const auto node = std::size_t(corners[c]);
        pieces[c] = piece_of[node];
        moves_as_one =
            moves_as_one && pieces[c] == pieces[0] && (pieces[c] < 0 || member_of[node]->held == 0);
      }
      if (moves_as_one) continue;
      std::array<NodeMotions, 8> z{};
      for (int c = 0; c < 8; ++c) {
        if (pieces[c] < 0) continue;
        const Member& member = *member_of[std::size_t(corners[c])];
        z[c] = motions_of(member.arm, member.held);
      }
      Matrix24 k;
      for (int n = 0; n < 24; ++n) {
        for (int m = 0; m < 24; ++m) {
          k[n][m] = material.moduli.shear[of] * material.matrix.shear[n][m] +
                    material.moduli.bulk[of] * material.matrix.bulk[n][m] +
                    material.moduli.inertia[of] * material.matrix.mass[n][m];
        }
      }
      add_element(k, pieces, z, of_blocks[b]);
    }
  };
  for (const std::vector<std::int32_t>& blocks : m_blocks) {
    tbb::parallel_for(std::size_t(0), blocks.size(),
                      [&](std::size_t n) { add_block(std::size_t(blocks[n])); });
  }
  std::map<PiecePair, Matrix6> sums;
  for (const auto& of_block : of_blocks) {
    for (const auto& [pair, part] : of_block) {
      Matrix6& sum = sums[pair];
      for (int n = 0; n < 36; ++n) sum[n / 6][n % 6] += part[n / 6][n % 6];
    }
  }
  return as_blocks(sums, count());
}

void ThinPieces::take_forces(const float* r) {
  std::fill(m_forces.begin(), m_forces.end(), 0.0F);
  add_forces(r);
}

void ThinPieces::add_forces(const float* r) {
  for_pieces(count(), [&](std::size_t piece) {
    Vec3d force(0.0), moment(0.0);
    for (std::size_t n = m_begin[piece]; n < m_begin[piece + 1]; ++n) {
      const Member& member = m_members[n];
      Vec3d value;
      for (int a = 0; a < 3; ++a) {
        value[a] = (member.held >> a & 1) != 0 ? 0 : r[3 * std::size_t(member.node) + a];
      }
      force += value;
      moment += Vec3d(member.arm).cross(value);
    }
    for (int a = 0; a < 3; ++a) {
      m_forces[6 * piece + a] += float(force[a]);
      m_forces[6 * piece + 3 + a] += float(moment[a]);
    }
  });
}

void ThinPieces::solve() {
  m_solver->solve(m_forces.data(), m_motions.data());
}

void ThinPieces::add_motions(float* z) const {
  for_pieces(count(), [&](std::size_t piece) {
    for (std::size_t n = m_begin[piece]; n < m_begin[piece + 1]; ++n) {
      const Member& member = m_members[n];
      const Vec3f moved = moved_by(&m_motions[6 * piece], member.arm);
      for (int a = 0; a < 3; ++a) {
        if ((member.held >> a & 1) == 0) z[3 * std::size_t(member.node) + a] += moved[a];
      }
    }
  });
}

void ThinPieces::clear(float* z) const {
  for (const Member& member : m_members) std::fill_n(z + 3 * std::size_t(member.node), 3, 0.0F);
}

std::size_t ThinPieces::bytes() const {
  std::size_t sum = m_members.capacity() * sizeof(Member) +
                    m_begin.capacity() * sizeof(std::size_t) +
                    (m_forces.capacity() + m_motions.capacity()) * sizeof(float);
  for (const std::vector<std::int32_t>& blocks : m_blocks) sum += blocks.capacity() * 4;
  return sum + (m_solver ? m_solver->bytes() : 0);
}

}  // namespace supple
