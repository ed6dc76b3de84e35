#include "lib/fem/voxel/block_matrix.h"

#include <algorithm>
#include <cstring>

#include "volumes/base/parallel.h"
#include "volumes/base/simd.h"

namespace supple {

namespace {

/// Elements with a matrix that have a node, as 8 element + corner.
struct ElementsAround {
  std::vector<std::int64_t> begin;
  std::vector<std::int64_t> corner;

  ElementsAround(const HexMesh& mesh, const CellMatrices& matrices)
      : begin(mesh.node_count() + 1, 0) {
    for (std::int32_t e = 0; e < mesh.element_count(); ++e) {
      if (!matrices.has(std::size_t(e))) continue;
      for (const NodeIndex node : mesh.corners(e)) ++begin[node + 1];
    }
    for (NodeIndex n = 0; n < mesh.node_count(); ++n) begin[n + 1] += begin[n];
    corner.resize(begin.back());
    std::vector<std::int64_t> next(begin.begin(), begin.end() - 1);
    for (std::int32_t e = 0; e < mesh.element_count(); ++e) {
      if (!matrices.has(std::size_t(e))) continue;
      const Corners corners = mesh.corners(e);
      for (int c = 0; c < 8; ++c) corner[next[corners[c]]++] = 8 * std::int64_t(e) + c;
    }
  }
};

constexpr Grain kRows{64};

/// Neighbours of a node, itself included, ascending.
void neighbours_of(const HexMesh& mesh, const ElementsAround& around, NodeIndex node,
                   std::vector<NodeIndex>& out) {
  out.clear();
  for (std::int64_t n = around.begin[node]; n < around.begin[node + 1]; ++n) {
    const Corners corners = mesh.corners(std::int32_t(around.corner[n] / 8));
    out.insert(out.end(), corners.begin(), corners.end());
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

template <class T>
using Four = Pack<T, 4>;

template <class T>
Four<T> four_at(const T* values) {
  return load_pack<Four<T>>(values);
}

}  // namespace

template <class T>
void BlockMatrix<T>::subtract(const T* x, T* y) const {
  parallel_for(NodeIndex(rows()), kRows, [&](NodeIndex row) {
    // One sum per column of the blocks; the fourth lane has what lies behind.
    Four<T> sums[3] = {};
    for (std::int64_t n = row_begin[row]; n < row_begin[row + 1]; ++n) {
      const T* from = x + 3 * std::size_t(column[n]);
      const T* value = blocks[n].value;
      sums[0] += four_at(value) * from[0];
      sums[1] += four_at(value + 3) * from[1];
      sums[2] += __builtin_shufflevector(four_at(value + 5), Four<T>{}, 1, 2, 3, 0) * from[2];
    }
    const Four<T> sum = sums[0] + sums[1] + sums[2];
    for (int a = 0; a < 3; ++a) y[3 * std::size_t(row) + a] -= sum[a];
  });
}

template <class T>
std::vector<T> BlockMatrix<T>::diagonal() const {
  std::vector<T> out(3 * rows());
  for (std::size_t row = 0; row < rows(); ++row) {
    for (std::int64_t n = row_begin[row]; n < row_begin[row + 1]; ++n) {
      if (std::size_t(column[n]) != row) continue;
      for (int a = 0; a < 3; ++a) out[3 * row + a] = blocks[n].value[4 * a];
    }
  }
  return out;
}

template <class T>
std::size_t BlockMatrix<T>::bytes() const {
  return row_begin.capacity() * 8 + column.capacity() * 4 + blocks.capacity() * sizeof(Block);
}

template <class T>
BlockMatrix<T> assemble(const HexMesh& mesh, const CellMatrices& matrices) {
  const ElementsAround around(mesh, matrices);
  BlockMatrix<T> out;
  out.row_begin.assign(mesh.node_count() + 1, 0);
  parallel_for(mesh.node_count(), kRows, [&](NodeIndex node) {
    std::vector<NodeIndex> columns;
    neighbours_of(mesh, around, node, columns);
    out.row_begin[node + 1] = std::int64_t(columns.size());
  });
  for (NodeIndex n = 0; n < mesh.node_count(); ++n) out.row_begin[n + 1] += out.row_begin[n];
  out.column.resize(out.row_begin.back());
  out.blocks.resize(out.row_begin.back());
  parallel_for(mesh.node_count(), kRows, [&](NodeIndex node) {
    std::vector<NodeIndex> columns;
    neighbours_of(mesh, around, node, columns);
    std::vector<std::array<double, 9>> sums(columns.size());
    for (std::int64_t n = around.begin[node]; n < around.begin[node + 1]; ++n) {
      const std::int64_t element = around.corner[n] / 8;
      const int row = int(around.corner[n] % 8);
      const Corners corners = mesh.corners(std::int32_t(element));
      for (int c = 0; c < 8; ++c) {
        const auto place =
            std::lower_bound(columns.begin(), columns.end(), corners[c]) - columns.begin();
        for (int a = 0; a < 3; ++a) {
          for (int b = 0; b < 3; ++b) {
            sums[place][3 * a + b] += matrices[element](3 * row + a, 3 * c + b);
          }
        }
      }
    }
    for (std::size_t n = 0; n < columns.size(); ++n) {
      out.column[out.row_begin[node] + n] = columns[n];
      for (int ab = 0; ab < 9; ++ab) {
        out.blocks[out.row_begin[node] + n].value[3 * (ab % 3) + ab / 3] = T(sums[n][ab]);
      }
    }
  });
  return out;
}

template struct BlockMatrix<float>;
template struct BlockMatrix<double>;
template BlockMatrix<float> assemble(const HexMesh&, const CellMatrices&);
template BlockMatrix<double> assemble(const HexMesh&, const CellMatrices&);

}  // namespace supple
