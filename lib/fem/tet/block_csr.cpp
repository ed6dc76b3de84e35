#include "lib/fem/tet/block_csr.h"

#include <algorithm>

namespace supple {

namespace {

Matrix9 product(const Matrix9& a, const Matrix9& b) {
  Matrix9 out{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) out[3 * i + j] += a[3 * i + k] * b[3 * k + j];
    }
  }
  return out;
}

Matrix9 transposed(const Matrix9& a) {
  return {a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]};
}

}  // namespace

std::size_t NodeSets::largest() const {
  std::size_t most = 0;
  for (std::size_t set = 0; set < size(); ++set) most = std::max(most, count(set));
  return most;
}

SetsOfNodes::SetsOfNodes(std::size_t node_count, const NodeSets& sets) : begin(node_count + 1) {
  for (std::size_t set = 0; set < sets.size(); ++set) {
    for (std::size_t n = 0; n < sets.count(set); ++n) ++begin[std::size_t(sets.nodes(set)[n]) + 1];
  }
  for (std::size_t n = 0; n < node_count; ++n) begin[n + 1] += begin[n];
  places.resize(std::size_t(begin.back()));
  std::vector<std::int32_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t set = 0; set < sets.size(); ++set) {
    for (std::size_t n = 0; n < sets.count(set); ++n) {
      const std::size_t node = std::size_t(sets.nodes(set)[n]);
      places[std::size_t(next[node]++)] = {std::int32_t(set), std::int32_t(n)};
    }
  }
}

BlockCsr::BlockCsr(std::size_t node_count, const std::vector<const NodeSets*>& sets)
    : m_begin(node_count + 1) {
  std::vector<SetsOfNodes> of_node;
  of_node.reserve(sets.size());
  for (const NodeSets* some : sets) of_node.emplace_back(node_count, *some);
  std::vector<std::vector<NodeIndex>> rows(node_count);
  parallel_for(node_count, kRows, [&](std::size_t row) {
    std::vector<NodeIndex>& columns = rows[row];
    columns.push_back(NodeIndex(row));
    for (std::size_t kind = 0; kind < sets.size(); ++kind) {
      const SetsOfNodes& of = of_node[kind];
      for (std::int32_t n = of.begin[row]; n < of.begin[row + 1]; ++n) {
        const std::size_t set = std::size_t(of.places[std::size_t(n)].set);
        const NodeIndex* nodes = sets[kind]->nodes(set);
        columns.insert(columns.end(), nodes, nodes + sets[kind]->count(set));
      }
    }
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  });
  for (std::size_t row = 0; row < node_count; ++row) {
    m_begin[row + 1] = m_begin[row] + std::int64_t(rows[row].size());
  }
  m_columns.resize(std::size_t(m_begin.back()));
  m_blocks.resize(m_columns.size(), Matrix9{});
  parallel_for(node_count, kRows, [&](std::size_t row) {
    std::copy(rows[row].begin(), rows[row].end(), m_columns.begin() + m_begin[row]);
  });
}

void BlockCsr::set_zero() {
  std::fill(m_blocks.begin(), m_blocks.end(), Matrix9{});
}

BlockCsr BlockCsr::in_frames(const std::vector<Matrix9>& frames) const {
  BlockCsr out = *this;
  parallel_for(node_count(), kRows, [&](std::size_t row) {
    for (std::size_t n = std::size_t(m_begin[row]); n < std::size_t(m_begin[row + 1]); ++n) {
      const Matrix9 &q = frames[row], &p = frames[std::size_t(m_columns[n])];
      if (q == kIdentity9 && p == kIdentity9) continue;
      out.m_blocks[n] = product(product(q, m_blocks[n]), transposed(p));
    }
  });
  return out;
}

template <int sign, class T>
void BlockCsr::multiply(const T* x, double* y) const {
  parallel_for(node_count(), kRows, [&](std::size_t row) {
    double sum[3] = {0, 0, 0};
    for (std::size_t n = std::size_t(m_begin[row]); n < std::size_t(m_begin[row + 1]); ++n) {
      const Matrix9& block = m_blocks[n];
      const T* of = x + 3 * std::size_t(m_columns[n]);
      const double a = double(of[0]), b = double(of[1]), c = double(of[2]);
      sum[0] += block[0] * a + block[1] * b + block[2] * c;
      sum[1] += block[3] * a + block[4] * b + block[5] * c;
      sum[2] += block[6] * a + block[7] * b + block[8] * c;
    }
    for (std::size_t m = 0; m < 3; ++m) y[3 * row + m] += sign * sum[m];
  });
}

void BlockCsr::add(const float* x, double* y) const {
  multiply<1>(x, y);
}
void BlockCsr::add(const double* x, double* y) const {
  multiply<1>(x, y);
}
void BlockCsr::subtract(const double* x, double* y) const {
  multiply<-1>(x, y);
}

std::vector<float> BlockCsr::diagonal() const {
  std::vector<float> values(3 * node_count());
  for (std::size_t row = 0; row < node_count(); ++row) {
    const auto first = m_columns.begin() + m_begin[row],
               last = m_columns.begin() + m_begin[row + 1];
    const auto at = std::lower_bound(first, last, NodeIndex(row)) - m_columns.begin();
    for (std::size_t m = 0; m < 3; ++m)
      values[3 * row + m] = float(m_blocks[std::size_t(at)][4 * m]);
  }
  return values;
}

std::size_t BlockCsr::bytes() const {
  return m_begin.capacity() * sizeof(std::int64_t) + m_columns.capacity() * sizeof(NodeIndex) +
         m_blocks.capacity() * sizeof(Matrix9);
}

}  // namespace supple
