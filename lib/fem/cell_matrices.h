// Stiffness matrices of single coarse elements by Galerkin, P^T K P, from those of their children
// down to the voxels. Sums are in double precision, so that small pieces that hold a large body are
// not lost among its rounding errors. 4.6 kB per element, while a hierarchy is made.
#pragma once

#include <vector>

#include "lib/fem/cell_classes.h"
#include "lib/fem/element_matrix.h"

namespace supple {

/// Matrices of the elements of one mesh.
class CellMatrices {
 public:
  /// Of voxels, without the rows and columns of held components. Voxels that are held as a whole
  /// have none, so that a million of them cost nothing.
  static CellMatrices of_voxels(const HexMesh& voxels, const VoxelMaterial& material,
                                const HeldBits& held);
  /// Of the cells of level 1.
  static CellMatrices of_cells(const CellClasses& cells, const VoxelMaterial& material);
  /// Of the cells of level 2, straight from the voxels, 37,000 multiply-adds each.
  static CellMatrices of_large_cells(const HexMesh& cells_mesh, const Coarsening& coarsening,
                                     const CellClasses& cells, const VoxelMaterial& material,
                                     std::int32_t count);
  /// Of the next coarser mesh.
  CellMatrices coarser(const HexMesh& mesh, const Coarsening& coarsening, std::int32_t count) const;

  bool has(std::size_t element) const { return m_place.empty() || m_place[element] >= 0; }
  /// Of an element that has one.
  const Matrix24& operator[](std::size_t element) const {
    return m_matrices[m_place.empty() ? element : std::size_t(m_place[element])];
  }
  std::size_t size() const { return m_matrices.size(); }
  std::size_t bytes() const { return m_matrices.capacity() * sizeof(Matrix24); }

 private:
  std::vector<std::int32_t> m_place;  // among the matrices, or -1; empty: every element has one
  std::vector<Matrix24> m_matrices;
};

}  // namespace supple
