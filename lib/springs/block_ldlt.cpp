#include "lib/springs/block_ldlt.h"

#include <algorithm>
#include <cstring>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include "volumes/base/simd.h"

namespace supple {

namespace {

/// An order of elimination with little fill: the row at each place.
std::vector<int> elimination_order(int rows, const std::vector<std::array<int, 2>>& couplings) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int n = 0; n < rows; ++n) entries.emplace_back(n, n, 1.0);
  for (const auto& c : couplings) {
    entries.emplace_back(c[0], c[1], 1.0);
    entries.emplace_back(c[1], c[0], 1.0);
  }
  Eigen::SparseMatrix<double> pattern(rows, rows);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern, order);
  return {order.indices().data(), order.indices().data() + rows};
}

/// A column of a block, in one register where the machine has such.
using ColumnPack = Pack<double, 4>;

template <class Block>
inline ColumnPack column_of(const Block& a, int c) {
  return load_pack<ColumnPack>(a.column[c]);
}

/// y -= a b^T, a by its columns.
template <class Block>
inline void subtract_product(Block& y, const ColumnPack& a0, const ColumnPack& a1,
                             const ColumnPack& a2, const Block& b) {
  for (int c = 0; c < 3; ++c) {
    const ColumnPack sum =
        column_of(y, c) - a0 * b.column[0][c] - a1 * b.column[1][c] - a2 * b.column[2][c];
    std::memcpy(y.column[c], &sum, sizeof sum);
  }
}

/// The product a b of two blocks, b symmetric.
template <class Block>
inline Block product(const Block& a, const Block& b) {
  Block result;
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 4; ++r) {
      result.column[c][r] = a.column[0][r] * b.column[c][0] + a.column[1][r] * b.column[c][1] +
                            a.column[2][r] * b.column[c][2];
    }
  }
  return result;
}

template <class Block>
Block block_of(const SymmetricBlock& s) {
  return {{{s[0], s[3], s[4], 0}, {s[3], s[1], s[5], 0}, {s[4], s[5], s[2], 0}}};
}

/// Inverts a block; false when it is not positive definite.
template <class Block>
bool invert_block(const Block& a, Block& inverse) {
  SymmetricBlock result;
  if (!invert({a.column[0][0], a.column[1][1], a.column[2][2], a.column[0][1], a.column[0][2],
               a.column[1][2]},
              result)) {
    return false;
  }
  inverse = block_of<Block>(result);
  return true;
}

template <class Block>
inline Vec3d block_times(const Block& a, const Vec3d& x) {
  Vec3d y(0.0);
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) y[r] += a.column[c][r] * x[c];
  }
  return y;
}

template <class Block>
inline Vec3d transposed_times(const Block& a, const Vec3d& x) {
  Vec3d y;
  for (int c = 0; c < 3; ++c) {
    y[c] = a.column[c][0] * x.x + a.column[c][1] * x.y + a.column[c][2] * x.z;
  }
  return y;
}

}  // namespace

BlockLdlt::BlockLdlt(int rows, const std::vector<std::array<int, 2>>& couplings)
    : m_order(elimination_order(rows, couplings)), m_parent(rows, -1) {
  std::vector<int> place(rows);
  for (int n = 0; n < rows; ++n) place[m_order[n]] = n;
  // Couplings by the later of their places.
  m_entry_begin.assign(rows + 1, 0);
  for (const auto& c : couplings) ++m_entry_begin[std::max(place[c[0]], place[c[1]]) + 1];
  for (int n = 0; n < rows; ++n) m_entry_begin[n + 1] += m_entry_begin[n];
  m_entries.resize(couplings.size());
  std::vector<int> next(m_entry_begin.begin(), m_entry_begin.end() - 1);
  for (std::size_t n = 0; n < couplings.size(); ++n) {
    const int a = place[couplings[n][0]], b = place[couplings[n][1]];
    m_entries[next[std::max(a, b)]++] = {std::min(a, b), int(n)};
  }
  // The elimination tree and the length of L's columns (Davis, section 4.10).
  std::vector<int> length(rows, 0);
  m_mark.assign(rows, -1);
  for (int k = 0; k < rows; ++k) {
    m_mark[k] = k;
    for (int e = m_entry_begin[k]; e < m_entry_begin[k + 1]; ++e) {
      for (int i = m_entries[e].row; m_mark[i] != k; i = m_parent[i]) {
        if (m_parent[i] < 0) m_parent[i] = k;
        ++length[i];
        m_mark[i] = k;
      }
    }
  }
  m_column_begin.assign(rows + 1, 0);
  for (int n = 0; n < rows; ++n) {
    m_column_begin[n + 1] = m_column_begin[n] + length[n];
    m_products += 0.5 * length[n] * length[n];
  }
}

/// Finds the columns that row k of L has, in an order in which each follows those that change it:
/// m_stack from m_top on.
void BlockLdlt::find_reach(int k) {
  const int rows = int(m_order.size());
  m_top = rows;
  m_mark[k] = k;
  for (int e = m_entry_begin[k]; e < m_entry_begin[k + 1]; ++e) {
    int length = 0;
    for (int i = m_entries[e].row; m_mark[i] != k; i = m_parent[i]) {
      m_stack[length++] = i;
      m_mark[i] = k;
    }
    while (length > 0) m_stack[--m_top] = m_stack[--length];
  }
}

bool BlockLdlt::factorise(const std::vector<SymmetricBlock>& diagonal,
                          const std::vector<SymmetricBlock>& coupling) {
  const int rows = int(m_order.size());
  m_row.resize(m_column_begin[rows]);
  m_lower.resize(m_column_begin[rows]);
  m_inverse_diagonal.resize(rows);
  m_filled.resize(rows);
  m_stack.resize(rows);
  std::fill(m_mark.begin(), m_mark.end(), -1);
  m_work.assign(rows, Block{});
  std::copy(m_column_begin.begin(), m_column_begin.end() - 1, m_filled.begin());
  for (int k = 0; k < rows; ++k) {
    find_reach(k);
    for (int e = m_entry_begin[k]; e < m_entry_begin[k + 1]; ++e) {
      m_work[m_entries[e].row] = block_of<Block>(coupling[m_entries[e].coupling]);
    }
    Block pivot = block_of<Block>(diagonal[m_order[k]]);
    for (int s = m_top; s < rows; ++s) {
      // Row k of L D, block i: then L_ki = y_i / D_i.
      const int i = m_stack[s];
      const Block y = m_work[i];
      m_work[i] = Block{};
      const int end = m_filled[i];
      const ColumnPack y0 = column_of(y, 0), y1 = column_of(y, 1), y2 = column_of(y, 2);
      for (int p = m_column_begin[i]; p < end; ++p) {
        subtract_product(m_work[m_row[p]], y0, y1, y2, m_lower[p]);
      }
      const Block lower = product(y, m_inverse_diagonal[i]);
      subtract_product(pivot, y0, y1, y2, lower);
      m_row[end] = k;
      m_lower[end] = lower;
      ++m_filled[i];
    }
    if (!invert_block(pivot, m_inverse_diagonal[k])) return false;
  }
  return true;
}

void BlockLdlt::solve(std::vector<Vec3d>& x) const {
  const int rows = int(m_order.size());
  std::vector<Vec3d> y(rows);
  for (int n = 0; n < rows; ++n) y[n] = x[m_order[n]];
  for (int i = 0; i < rows; ++i) {
    for (int p = m_column_begin[i]; p < m_column_begin[i + 1]; ++p) {
      y[m_row[p]] -= block_times(m_lower[p], y[i]);
    }
  }
  for (int i = rows - 1; i >= 0; --i) {
    y[i] = block_times(m_inverse_diagonal[i], y[i]);
    for (int p = m_column_begin[i]; p < m_column_begin[i + 1]; ++p) {
      y[i] -= transposed_times(m_lower[p], y[m_row[p]]);
    }
  }
  for (int n = 0; n < rows; ++n) x[m_order[n]] = y[n];
}

std::size_t BlockLdlt::bytes() const {
  return (m_lower.size() + m_inverse_diagonal.size() + m_work.size()) * sizeof(Block) +
         (m_order.size() * 6 + m_row.size()) * sizeof(int) + m_entries.size() * sizeof(Entry);
}

}  // namespace supple
