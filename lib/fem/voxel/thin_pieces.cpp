#include "lib/fem/voxel/thin_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "lib/fem/voxel/block_matrix.h"
#include "lib/fem/voxel/element_matrix.h"
#include "volumes/base/parallel.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

using Matrix6 = std::array<std::array<double, 6>, 6>;
using PiecePair = std::pair<std::int32_t, std::int32_t>;

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

/// Way in mm from the first block to a corner of an element: world coordinates may be large.
Vec3d way_to(const HexMesh& mesh, std::size_t block, int offset, int corner) {
  const Vec3d cells(mesh.origin[block] - mesh.origin[0] + brick_local(offset) +
                    cell_corner(corner));
  const auto& axes = mesh.geometry.axes_mm();
  return axes[0] * cells.x + axes[1] * cells.y + axes[2] * cells.z;
}

constexpr Grain kPieces{16};

}  // namespace

ThinPieces::ThinPieces(const HexOperator& stiffness, const VoxelMaterial& material,
                       const HeldBits& held, const Progress* progress) {
  const HexMesh& voxels = stiffness.mesh();
  const ThinParts parts = thin_parts(voxels, held, progress);
  if (parts.count == 0) return;
  gather(voxels, parts, held);
  std::vector<bool> is_thin(parts.piece_of.size());
  for (std::size_t n = 0; n < is_thin.size(); ++n) is_thin[n] = parts.piece_of[n] >= 0;
  m_groups = stiffness.groups_at(is_thin);
  poll(progress);
  const BlockMatrix<double> matrix = stiffness_of(voxels, material, parts.piece_of);
  poll(progress);
  m_solver.emplace(matrix);
  m_forces.resize(6 * count());
  m_motions.resize(6 * count());
}

void ThinPieces::gather(const HexMesh& voxels, const ThinParts& parts, const HeldBits& held) {
  const PieceOfNode& piece_of = parts.piece_of;
  m_begin.assign(parts.count + 1, 0);
  for (const std::int32_t piece : piece_of) {
    if (piece >= 0) ++m_begin[std::size_t(piece) + 1];
  }
  for (std::size_t n = 0; n < count(); ++n) m_begin[n + 1] += m_begin[n];
  m_members.resize(m_begin.back());
  std::vector<std::size_t> next(m_begin.begin(), m_begin.end() - 1);
  // Each node takes its place from the first element that has it.
  std::vector<bool> is_placed(piece_of.size(), false);
  for (std::size_t b = 0; b < voxels.block_count(); ++b) {
    for (std::int32_t e = voxels.element_begin[b]; e < voxels.element_begin[b + 1]; ++e) {
      const Corners corners = voxels.corners_in(b, e);
      for (int c = 0; c < 8; ++c) {
        const auto node = std::size_t(corners[c]);
        if (piece_of[node] < 0 || is_placed[node]) continue;
        is_placed[node] = true;
        m_members[next[std::size_t(piece_of[node])]++] = {
            corners[c], Vec3f(way_to(voxels, b, voxels.offset[e], c)), held[node]};
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
}

BlockMatrix<double> ThinPieces::stiffness_of(const HexMesh& voxels, const VoxelMaterial& material,
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
  for (const std::vector<std::int32_t>& blocks : m_groups.blocks) {
    parallel_for(blocks.size(), [&](std::size_t n) { add_block(std::size_t(blocks[n])); });
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
  parallel_for(count(), kPieces, [&](std::size_t piece) {
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
  parallel_for(count(), kPieces, [&](std::size_t piece) {
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
  parallel_for(count(), kPieces, [&](std::size_t piece) {
    for (std::size_t n = m_begin[piece]; n < m_begin[piece + 1]; ++n) {
      std::fill_n(z + 3 * std::size_t(m_members[n].node), 3, 0.0F);
    }
  });
}

std::size_t ThinPieces::bytes() const {
  std::size_t sum = m_members.capacity() * sizeof(Member) +
                    m_begin.capacity() * sizeof(std::size_t) +
                    (m_forces.capacity() + m_motions.capacity()) * sizeof(float) + m_groups.bytes();
  return sum + (m_solver ? m_solver->bytes() : 0);
}

}  // namespace supple
