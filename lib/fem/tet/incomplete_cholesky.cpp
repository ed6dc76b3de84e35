#include "lib/fem/tet/incomplete_cholesky.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"

namespace supple {

namespace {

/// Parts of the diagonal by which it is raised where it must be: at first, by which factor each
/// time after, and where that ends.
constexpr double kFirstShift = 1e-3, kShiftGrowth = 3, kLargestShift = 100;

/// a -= b c^T.
void subtract_product(const Matrix9& b, const Matrix9& c, Matrix9& a) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      a[3 * i + j] -=
          b[3 * i] * c[3 * j] + b[3 * i + 1] * c[3 * j + 1] + b[3 * i + 2] * c[3 * j + 2];
    }
  }
}

/// Finds the inverse of a symmetric block; false unless it is positive definite.
bool invert(const Matrix9& a, Matrix9& inverse) {
  const Matrix9 cofactor = cofactors(a);
  const double determinant = determinant_of(a, cofactor);
  if (!(a[0] > 0 && cofactor[8] > 0 && determinant > 0)) return false;
  for (std::size_t n = 0; n < 9; ++n) inverse[n] = cofactor[n] / determinant;
  return true;
}

}  // namespace

Matrix9 free_block(const Matrix9& block, std::uint8_t row_held, std::uint8_t column_held,
                   bool is_diagonal) {
  if ((row_held | column_held) == 0) return block;
  Matrix9 out = block;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (((row_held >> i | column_held >> j) & 1) == 0) continue;
      out[3 * i + j] = is_diagonal && i == j ? 1 : 0;
    }
  }
  return out;
}

IncompleteCholesky::IncompleteCholesky(const BlockCsr& matrix, const HeldBits& held)
    : m_begin(matrix.node_count() + 1), m_inverse(matrix.node_count()) {
  for (std::size_t row = 0; row < matrix.node_count(); ++row) {
    for (std::int64_t n = matrix.begin()[row]; n < matrix.begin()[row + 1]; ++n) {
      const NodeIndex column = matrix.columns()[std::size_t(n)];
      if (std::size_t(column) < row) m_columns.push_back(column);
    }
    m_begin[row + 1] = std::int64_t(m_columns.size());
  }
  m_lower.resize(m_columns.size());
  while (!factorize(matrix, held)) {
    m_shift = m_shift == 0 ? kFirstShift : m_shift * kShiftGrowth;
    if (m_shift > kLargestShift) {
      throw Error("finite elements: a stiffness matrix whose diagonal is not above 0");
    }
  }
}

/// Finds row after row: U_ij = A_ij - sum over k < j of U_ik L_jk^T, L_ij = U_ij D_j^-1,
/// D_i = A_ii - sum U_ij L_ij^T.
bool IncompleteCholesky::factorize(const BlockCsr& matrix, const HeldBits& held) {
  std::vector<Matrix9> lower(m_lower.size()), inverse(m_inverse.size());
  std::vector<Matrix9> u;  // of the row
  for (std::size_t row = 0; row < m_inverse.size(); ++row) {
    const std::size_t begin = std::size_t(m_begin[row]);
    const std::size_t count = std::size_t(m_begin[row + 1]) - begin;
    const std::size_t first = std::size_t(matrix.begin()[row]);
    u.resize(count);
    Matrix9 diagonal = free_block(matrix.blocks()[first + count], held[row], held[row], true);
    for (std::size_t m = 0; m < 3; ++m) diagonal[4 * m] += m_shift * std::abs(diagonal[4 * m]);
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t column = std::size_t(m_columns[begin + n]);
      u[n] = free_block(matrix.blocks()[first + n], held[row], held[column], false);
      std::size_t k = 0, other = std::size_t(m_begin[column]);
      const std::size_t other_end = std::size_t(m_begin[column + 1]);
      while (k < n && other < other_end) {
        const NodeIndex a = m_columns[begin + k], b = m_columns[other];
        if (a == b) subtract_product(u[k], lower[other], u[n]);
        k += a <= b;
        other += b <= a;
      }
      // L_ij = U_ij D_j^-1, of which D^-1 is symmetric.
      Matrix9 of_row{};
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
          for (std::size_t m = 0; m < 3; ++m) {
            of_row[3 * i + j] += u[n][3 * i + m] * inverse[column][3 * m + j];
          }
        }
      }
      lower[begin + n] = of_row;
      subtract_product(u[n], of_row, diagonal);
    }
    if (!invert(diagonal, inverse[row])) return false;
  }
  const auto rounded = [](const Matrix9& block) {
    Block out;
    std::transform(block.begin(), block.end(), out.begin(), [](double v) { return float(v); });
    return out;
  };
  std::transform(lower.begin(), lower.end(), m_lower.begin(), rounded);
  std::transform(inverse.begin(), inverse.end(), m_inverse.begin(), rounded);
  return true;
}

void IncompleteCholesky::solve(const float* r, float* z) const {
  const std::size_t rows = m_inverse.size();
  for (std::size_t row = 0; row < rows; ++row) {
    float y[3] = {r[3 * row], r[3 * row + 1], r[3 * row + 2]};
    for (std::size_t n = std::size_t(m_begin[row]); n < std::size_t(m_begin[row + 1]); ++n) {
      const Block& block = m_lower[n];
      const float* x = z + 3 * std::size_t(m_columns[n]);
      y[0] -= block[0] * x[0] + block[1] * x[1] + block[2] * x[2];
      y[1] -= block[3] * x[0] + block[4] * x[1] + block[5] * x[2];
      y[2] -= block[6] * x[0] + block[7] * x[1] + block[8] * x[2];
    }
    for (std::size_t m = 0; m < 3; ++m) z[3 * row + m] = y[m];
  }
  for (std::size_t row = 0; row < rows; ++row) {
    const Block& block = m_inverse[row];
    float* x = z + 3 * row;
    const float y[3] = {x[0], x[1], x[2]};
    for (std::size_t m = 0; m < 3; ++m) {
      x[m] = block[3 * m] * y[0] + block[3 * m + 1] * y[1] + block[3 * m + 2] * y[2];
    }
  }
  for (std::size_t row = rows; row-- > 0;) {
    const float* y = z + 3 * row;
    for (std::size_t n = std::size_t(m_begin[row]); n < std::size_t(m_begin[row + 1]); ++n) {
      const Block& block = m_lower[n];
      float* x = z + 3 * std::size_t(m_columns[n]);
      x[0] -= block[0] * y[0] + block[3] * y[1] + block[6] * y[2];
      x[1] -= block[1] * y[0] + block[4] * y[1] + block[7] * y[2];
      x[2] -= block[2] * y[0] + block[5] * y[1] + block[8] * y[2];
    }
  }
}

std::size_t IncompleteCholesky::bytes() const {
  return m_begin.capacity() * sizeof(std::int64_t) + m_columns.capacity() * sizeof(NodeIndex) +
         (m_lower.capacity() + m_inverse.capacity()) * sizeof(Block);
}

}  // namespace supple
