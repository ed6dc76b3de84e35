// Incomplete Cholesky factors of a symmetric matrix of 3 x 3 blocks, as preconditioner:
// K ~ L D L^T with L where K has blocks (IC(0) by blocks; Meijerink & van der Vorst 1977).
//
// Rows and columns of held components count as those of the identity. Where a block of D is not
// positive, which happens near nu = 1/2, the diagonal is raised and all begins anew (Manteuffel
// 1980). Factors are found in double precision and applied in single, one row after the other: so
// they are the same on any number of threads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lib/fem/nodal_loads.h"
#include "lib/fem/tet/block_csr.h"

namespace supple {

class IncompleteCholesky {
 public:
  /// Throws Error where the matrix has a diagonal that is not above 0.
  IncompleteCholesky(const BlockCsr& matrix, const HeldBits& held);

  /// z = (L D L^T)^-1 r.
  void solve(const float* r, float* z) const;
  /// The part by which the diagonal was raised.
  double shift() const { return m_shift; }
  std::size_t bytes() const;

 private:
  using Block = std::array<float, 9>;
  bool factorize(const BlockCsr& matrix, const HeldBits& held);

  std::vector<std::int64_t> m_begin;  // of the blocks below the diagonal
  std::vector<NodeIndex> m_columns;
  std::vector<Block> m_lower;    // L
  std::vector<Block> m_inverse;  // D^-1
  double m_shift = 0;
};

/// The block with rows and columns of held components made those of the identity.
Matrix9 free_block(const Matrix9& block, std::uint8_t row_held, std::uint8_t column_held,
                   bool is_diagonal);

}  // namespace supple
