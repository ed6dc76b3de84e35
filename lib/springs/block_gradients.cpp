#include "lib/springs/block_gradients.h"

#include <algorithm>
#include <numeric>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

constexpr std::size_t kChunk = 1024;         // rows
constexpr std::size_t kParallelChunks = 16;  // from which on waking threads pays

}  // namespace

BlockGradients::BlockGradients(int rows, const std::vector<std::array<int, 2>>& couplings)
    : m_first(std::size_t(rows) + 1, 0), m_entries(2 * couplings.size()) {
  for (const auto& [a, b] : couplings) {
    ++m_first[std::size_t(a) + 1];
    ++m_first[std::size_t(b) + 1];
  }
  std::partial_sum(m_first.begin(), m_first.end(), m_first.begin());
  std::vector<int> next = m_first;
  for (std::size_t n = 0; n < couplings.size(); ++n) {
    const auto& [a, b] = couplings[n];
    m_entries[std::size_t(next[std::size_t(a)]++)] = {b, int(n)};
    m_entries[std::size_t(next[std::size_t(b)]++)] = {a, int(n)};
  }
}

bool BlockGradients::prepare(const std::vector<SymmetricBlock>& diagonal,
                             const std::vector<SymmetricBlock>& coupling) {
  m_diagonal = diagonal.data();
  m_coupling = coupling.data();
  m_inverse_diagonal.resize(diagonal.size());
  for (std::size_t row = 0; row < diagonal.size(); ++row) {
    if (!invert(diagonal[row], m_inverse_diagonal[row])) return false;
  }
  return true;
}

/// Sums the values that `of_row` returns for each row.
template <class OfRow>
BlockGradients::Sums BlockGradients::sum(const OfRow& of_row) const {
  const std::size_t rows = m_first.size() - 1, chunks = (rows + kChunk - 1) / kChunk;
  std::vector<Sums> of_chunk(chunks, Sums{});
  const auto sum_chunk = [&](std::size_t chunk) {
    const std::size_t end = std::min(rows, (chunk + 1) * kChunk);
    Sums sums{};
    for (std::size_t row = chunk * kChunk; row < end; ++row) sums = sums + of_row(row);
    of_chunk[chunk] = sums;
  };
  if (chunks < kParallelChunks) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) sum_chunk(chunk);
  } else {
    parallel_for(chunks, sum_chunk);
  }
  return std::accumulate(of_chunk.begin(), of_chunk.end(), Sums{});
}

Vec3d BlockGradients::product(const std::vector<Vec3d>& x, std::size_t row) const {
  Vec3d sum = times(m_diagonal[row], x[row]);
  for (int n = m_first[row]; n < m_first[row + 1]; ++n) {
    const Entry& entry = m_entries[std::size_t(n)];
    sum += times(m_coupling[entry.coupling], x[std::size_t(entry.row)]);
  }
  return sum;
}

void BlockGradients::solve(std::vector<Vec3d>& b, double tolerance,
                           const Progress* progress) const {
  constexpr int kMaxSteps = 3000;
  const std::size_t rows = b.size();
  std::vector<Vec3d> x(rows, Vec3d(0.0)), z(rows), direction(rows, Vec3d(0.0)), product_of(rows);
  std::vector<Vec3d>& residual = b;
  const auto precondition = [&](std::size_t row) {
    z[row] = times(m_inverse_diagonal[row], residual[row]);
    return Sums{residual[row].length2(), residual[row].dot(z[row])};
  };
  Sums left = sum(precondition);
  const double enough = tolerance * tolerance * left.first;
  double part = 0;  // of the last direction
  for (int step = 0; step < kMaxSteps && left.first > enough; ++step) {
    poll(progress);
    sum([&](std::size_t row) {
      direction[row] = z[row] + direction[row] * part;
      return Sums{};
    });
    const Sums curvature = sum([&](std::size_t row) {
      product_of[row] = product(direction, row);
      return Sums{direction[row].dot(product_of[row]), 0};
    });
    const double length = left.second / curvature.first;
    const Sums next = sum([&](std::size_t row) {
      x[row] += direction[row] * length;
      residual[row] -= product_of[row] * length;
      return precondition(row);
    });
    part = next.second / left.second;
    left = next;
  }
  b = std::move(x);
}

std::size_t BlockGradients::bytes() const {
  return m_first.capacity() * sizeof(int) + m_entries.capacity() * sizeof(Entry) +
         m_inverse_diagonal.capacity() * sizeof(SymmetricBlock);
}

}  // namespace supple
