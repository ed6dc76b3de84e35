// K u on a mesh of hexahedra without a matrix: from classes per voxel and two reference matrices.
// Where the material has inertia (cell_classes.h), it is (K + c M) u with the consistent mass M.
// Level 0 has the voxels themselves. Level 1 has cells of 2^3 voxels by Galerkin, P^T K P, from the
// voxels' own stiffnesses and with the rows of held nodes of the voxel mesh left out.
//
// Cost on level 0 of a full cube of 64^3: some 170 million unknowns per second of processor time in
// single precision, 115 million in double. Memory beside the mesh: 0.9 bytes per unknown.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/fem/operator.h"
#include "lib/fem/voxel/cell_classes.h"
#include "lib/fem/voxel/element_groups.h"
#include "lib/fem/voxel/element_matrix.h"
#include "lib/fem/voxel/group_kernel.h"
#include "lib/fem/voxel/hex_mesh.h"

namespace supple {

/// The groups of eight elements that hold one with a node of a set.
struct GroupsAtNodes {
  BlocksByColour blocks;     // that have such a group
  std::vector<bool> is_one;  // per group of the operator
  double share = 0;          // of all groups

  std::size_t bytes() const;
};

class HexOperator final : public Operator {
 public:
  /// Makes the operator of the voxel mesh. Both must outlive this.
  HexOperator(const HexMesh& mesh, const VoxelMaterial& material);
  /// Makes that of the mesh that is one level coarser than the voxels'.
  HexOperator(const HexMesh& mesh, const CellClasses& cells, const VoxelMaterial& material);

  /// y += K x or y -= K x in the precision of y; three values per node.
  void add(const float* x, double* y) const override;
  void add(const double* x, double* y) const override;
  void add(const float* x, float* y) const;
  void subtract(const double* x, double* y) const override;
  void subtract(const float* x, float* y) const;
  GroupsAtNodes groups_at(const std::vector<bool>& is_node) const;
  /// The part of y -= K x of these groups alone.
  void subtract(const float* x, float* y, const GroupsAtNodes& groups) const;

  /// The diagonal of K.
  std::vector<float> diagonal() const override;

  const HexMesh& mesh() const { return *m_mesh; }
  std::size_t bytes() const override;

 private:
  template <class X, class T>
  void accumulate(const X* x, T* y, T sign, const GroupsAtNodes* groups = nullptr) const;
  template <class T>
  void apply_group(const ElementGroup& group, ElementLanes<T>* x) const;
  template <class T>
  LaneMaterial<T> material_of_lanes(const std::uint8_t* classes, unsigned present) const;
  template <class T>
  ChildLanes<T> children_of(const ElementGroup& group) const;
  void group_diagonal(const ElementGroup& group, ElementLanes<float>* out) const;
  /// Computes all groups, or these alone.
  template <class X, class T, class Compute>
  void for_each_group(const X* x, T* y, T sign, const GroupsAtNodes* groups,
                      Compute&& compute) const;

  const HexMesh* m_mesh;
  const VoxelMaterial* m_material;
  bool m_is_coarse, m_has_inertia;
  ElementGroups m_groups;
  /// Classes of the lanes (kind alike, 8 bytes) or of their children (72: [child][lane], and per
  /// child which lanes have it).
  std::vector<std::uint8_t> m_classes;
  std::vector<std::uint32_t> m_held;     // [child][lane] per constrained group
  std::vector<std::uint32_t> m_held_of;  // per group, where it begins in m_held
  VoxelKernel<float> m_voxel_single;
  VoxelKernel<double> m_voxel;
  AlikeKernel<float> m_alike_single;
  AlikeKernel<double> m_alike;
  /// Diagonals of M, A and the mass of a child on its parent, and of a voxel: [child][corner
  /// value].
  std::array<std::array<float, 24>, 8> m_shear_diagonal, m_bulk_diagonal, m_mass_diagonal;
};

}  // namespace supple
