// A sparse symmetric matrix of 3 x 3 blocks, rows of nodes: the operator of levels from 2 on, and
// what the coarsest level is factorised from. Blocks of a row are in ascending order of columns, so
// that sums are the same for any number of threads. 40 bytes per block, 27 blocks per inner node.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/fem/voxel/cell_matrices.h"
#include "lib/fem/voxel/hex_mesh.h"

namespace supple {

template <class T>
struct BlockMatrix {
  struct Block {
    T value[9];  // column by column, which are read as vectors
  };
  std::vector<std::int64_t> row_begin;
  std::vector<NodeIndex> column;
  std::vector<Block> blocks;

  std::size_t rows() const { return row_begin.size() - 1; }
  /// y -= K x.
  void subtract(const T* x, T* y) const;
  std::vector<T> diagonal() const;
  std::size_t bytes() const;
};

/// Sums the matrices of elements at their nodes; sums are in double precision.
template <class T>
BlockMatrix<T> assemble(const HexMesh& mesh, const CellMatrices& matrices);

}  // namespace supple
