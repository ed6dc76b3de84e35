// Rigid motions of the pieces of thin parts, a coarse space beside the levels of the cycle
// (Nicolaides 1987; Mandel 1993, the balancing preconditioner; rigid bodies as in Jonsthovel, van
// Gijzen, Vuik, Kasbergen and Scarpas 2009).
//
// A plate that is thinner than a coarse cell can neither bend nor turn there, and one motion that
// no level knows costs conjugate gradients iteration after iteration: in a head the septum of the
// nose takes half of them all. Here thin parts are cut into pieces of a few voxels, and each moves
// by itself in six ways, so that a plate bends from piece to piece.
//
// Cost: 20 bytes per node of thin parts, and the factors of E = Z^T K Z. In a cycle two products
// with K of the elements at pieces, and two solutions with E. Some 12 bytes per node of the
// mesh while the pieces are found.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "lib/fem/voxel/cell_classes.h"
#include "lib/fem/voxel/coarsest_solver.h"
#include "lib/fem/voxel/hex_operator.h"
#include "lib/fem/voxel/thin_parts.h"
#include "volumes/base/progress.h"
#include "volumes/base/vec.h"

namespace supple {

class ThinPieces {
 public:
  /// Throws Cancelled, and Error when E cannot be factorised.
  ThinPieces(const HexOperator& stiffness, const VoxelMaterial& material, const HeldBits& held,
             const Progress* progress);

  std::size_t count() const { return m_begin.size() - 1; }
  std::size_t node_count() const { return m_members.size(); }
  /// All elements with a node of a piece, and some others.
  const GroupsAtNodes& groups() const { return m_groups; }
  /// The n-th node of pieces.
  std::size_t node(std::size_t n) const { return std::size_t(m_members[n].node); }

  /// Forces Z^T r of the pieces, three values of r per node; held ones do not count.
  void take_forces(const float* r);
  /// Adds the forces of r to those taken.
  void add_forces(const float* r);
  /// Finds motions E^-1 Z^T r of the forces taken.
  void solve();
  /// z += Z (motions).
  void add_motions(float* z) const;
  /// Sets z to zero at the nodes of pieces.
  void clear(float* z) const;

  std::size_t bytes() const;

 private:
  struct Member {
    NodeIndex node;
    Vec3f arm;  // from the middle of its piece, in parts of the width of a block
    std::uint8_t held;
  };
  using PieceOfNode = std::vector<std::int32_t>;  // piece per node, or -1

  void gather(const HexMesh& voxels, const ThinParts& parts, const HeldBits& held);
  BlockMatrix<double> stiffness_of(const HexMesh& voxels, const VoxelMaterial& material,
                                   const PieceOfNode& piece_of) const;

  std::vector<std::size_t> m_begin{0};  // per piece, one more than pieces
  std::vector<Member> m_members;
  GroupsAtNodes m_groups;
  std::optional<CoarsestSolver> m_solver;
  std::vector<float> m_forces, m_motions;  // translation and turn of each piece
};

}  // namespace supple
