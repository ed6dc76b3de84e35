// Stiffness matrices of single coarse elements by Galerkin, P^T K P, from those of their children
// down to the voxels. Sums are in double precision, so that small pieces that hold a large body are
// not lost among its rounding errors. 2.4 kB per element, while a hierarchy is made.
#pragma once

#include <array>
#include <vector>

#include "lib/fem/voxel/cell_classes.h"
#include "lib/fem/voxel/element_matrix.h"

namespace supple {

/// The upper triangle of a symmetric matrix, row by row.
class SymmetricMatrix24 {
 public:
  SymmetricMatrix24() = default;
  explicit SymmetricMatrix24(const Matrix24& whole);

  double operator()(std::size_t row, std::size_t column) const {
    return m_upper[row < column ? place(row, column) : place(column, row)];
  }
  Matrix24 whole() const;

 private:
  static constexpr std::size_t place(std::size_t row, std::size_t column) {
    return row * (47 - row) / 2 + column;
  }

  std::array<double, 300> m_upper;
};

/// Matrices of the elements of one mesh.
class CellMatrices {
 public:
  /// Makes matrices of voxels, without the rows and columns of held components. Voxels that are
  /// held as a whole have none, so that a million of them cost nothing.
  static CellMatrices of_voxels(const HexMesh& voxels, const VoxelMaterial& material,
                                const HeldBits& held);
  /// Makes matrices of the cells of level 1.
  static CellMatrices of_cells(const CellClasses& cells, const VoxelMaterial& material);
  /// Makes matrices of the cells of level 2 from the voxels, 37,000 multiply-adds each.
  static CellMatrices of_large_cells(const HexMesh& cells_mesh, const Coarsening& coarsening,
                                     const CellClasses& cells, const VoxelMaterial& material,
                                     std::int32_t count);
  /// Makes matrices of the next coarser mesh.
  CellMatrices coarser(const HexMesh& mesh, const Coarsening& coarsening, std::int32_t count) const;

  bool has(std::size_t element) const { return m_place.empty() || m_place[element] >= 0; }
  /// Matrix of an element that has one.
  const SymmetricMatrix24& operator[](std::size_t element) const {
    return m_matrices[m_place.empty() ? element : std::size_t(m_place[element])];
  }
  std::size_t size() const { return m_matrices.size(); }
  std::size_t bytes() const { return m_matrices.capacity() * sizeof(SymmetricMatrix24); }

 private:
  std::vector<std::int32_t> m_place;  // among the matrices, or -1; empty: every element has one
  std::vector<SymmetricMatrix24> m_matrices;
};

}  // namespace supple
