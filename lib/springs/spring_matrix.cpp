#include "lib/springs/spring_matrix.h"

#include <algorithm>
#include <cmath>
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

namespace {

constexpr std::size_t kMaxDirectRows = 20000;
constexpr double kMaxProducts = 2e7;
constexpr double kFixing = 1e6;  // of a pressed node along its normal, beside its own stiffness

/// along * n n^T + across * (I - n n^T).
SymmetricBlock spring_block(const Vec3d& n, double along, double across) {
  const double d = along - across;
  return {across + d * n.x * n.x, across + d * n.y * n.y, across + d * n.z * n.z,
          d * n.x * n.y,          d * n.x * n.z,          d * n.y * n.z};
}

void add(SymmetricBlock& sum, const SymmetricBlock& block, double factor) {
  for (int n = 0; n < 6; ++n) sum[n] += factor * block[n];
}

}  // namespace

SpringMatrix::Pattern SpringMatrix::analyse(const SpringSystem& system,
                                            const std::vector<char>& is_held,
                                            const Progress* progress) {
  Pattern pattern;
  pattern.row_of_node.assign(system.node_count(), -1);
  for (std::size_t n = 0; n < system.node_count(); ++n) {
    if (is_held[n]) continue;
    pattern.row_of_node[n] = int(pattern.node_of_row.size());
    pattern.node_of_row.push_back(int(n));
  }
  const std::size_t rows = pattern.node_of_row.size();
  const auto for_free_pairs = [&](auto&& visit) {
    for (std::size_t n = 0; n < system.springs.size(); ++n) {
      if (n % kSpringsPerPoll == 0) poll(progress);
      const Spring& s = system.springs[n];
      const int a = pattern.row_of_node[s.a], b = pattern.row_of_node[s.b];
      if (a >= 0 && b >= 0) visit(n, std::min(a, b), std::max(a, b));
    }
  };
  // Springs by the lower row of their ends, then the upper rows of each row, ascending, once.
  std::vector<int> begin(rows + 1, 0);
  for_free_pairs([&](std::size_t, int a, int) { ++begin[std::size_t(a) + 1]; });
  for (std::size_t row = 0; row < rows; ++row) begin[row + 1] += begin[row];
  std::vector<int> next(begin.begin(), begin.end() - 1);
  std::vector<int> upper;
  upper.resize(std::size_t(begin[rows]));
  for_free_pairs(
      [&](std::size_t, int a, int b) { upper[std::size_t(next[std::size_t(a)]++)] = b; });
  pattern.first_of_row.assign(1, 0);
  pattern.first_of_row.reserve(rows + 1);
  for (std::size_t row = 0; row < rows; ++row) {
    if (row % kSpringsPerPoll == 0) poll(progress);
    const auto first = upper.begin() + begin[row], last = upper.begin() + begin[row + 1];
    std::sort(first, last);
    const auto end = std::unique(first, last);
    for (auto of = first; of != end; ++of) pattern.couplings.push_back({int(row), *of});
    pattern.first_of_row.push_back(int(pattern.couplings.size()));
  }
  pattern.couplings.shrink_to_fit();
  pattern.coupling_of_spring.assign(system.springs.size(), -1);
  for_free_pairs([&](std::size_t n, int a, int b) {
    pattern.coupling_of_spring[n] = pattern.coupling_of(a, b);
  });
  return pattern;
}

int SpringMatrix::Pattern::coupling_of(int a, int b) const {
  const auto row = std::size_t(std::min(a, b));
  for (int n = first_of_row[row]; n < first_of_row[row + 1]; ++n) {
    if (couplings[std::size_t(n)][1] == std::max(a, b)) return n;
  }
  return -1;
}

SpringMatrix::SpringMatrix(const SpringSystem& system, const std::vector<char>& is_held,
                           const Progress* progress)
    : m_pattern(analyse(system, is_held, progress)) {
  const std::size_t rows = m_pattern.node_of_row.size();
  if (rows <= kMaxDirectRows) m_factors.emplace(int(rows), m_pattern.couplings);
  if (m_factors && m_factors->products() <= kMaxProducts) return;
  m_factors.reset();
  poll(progress);
  m_gradients.emplace(int(rows), m_pattern.couplings);
}

void SpringMatrix::add_block(const SpringRows& place, const SymmetricBlock& block) {
  if (place.a >= 0) add(m_diagonal[place.a], block, 1);
  if (place.b >= 0) add(m_diagonal[place.b], block, 1);
  if (place.coupling >= 0) add(m_coupling[place.coupling], block, -1);
}

/// Adds a bound of W b'' (sum of c_i.de_i)^2 over the edges: at most W b'' sum |c_j| times the sum
/// of (c_i.de_i)^2 / |c_i|, a spring per edge. Ends that no spring joins count as if each were
/// joined to the world, twice as stiff.
void SpringMatrix::add_barrier(const SpringSystem& system) {
  for (const CellBarrier::Corner& corner : system.barrier.awake()) {
    const CellBarrier::Response response = system.barrier.response(corner, system.pos_mm);
    if (response.second_uj == 0) continue;
    const int a = m_pattern.row_of_node[corner.node[0]];
    double lengths = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (corner.node[axis + 1] >= 0) lengths += response.per_edge_1_mm[axis].length();
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double length = response.per_edge_1_mm[axis].length();
      if (corner.node[axis + 1] < 0 || length == 0) continue;
      const int b = m_pattern.row_of_node[corner.node[axis + 1]];
      SpringRows place = {a, b, -1};
      double stiffness = response.second_uj * lengths * length;
      if (a >= 0 && b >= 0) {
        place.coupling = m_pattern.coupling_of(a, b);
        if (place.coupling < 0) stiffness *= 2;
      }
      add_block(place, spring_block(response.per_edge_1_mm[axis] / length, stiffness, 0));
    }
  }
}

void SpringMatrix::assemble(const SpringSystem& system, double mass_factor, double damping_factor,
                            const std::vector<Vec3d>& damping_pos, const Progress* progress) {
  m_diagonal.resize(m_pattern.node_of_row.size());
  for (std::size_t row = 0; row < m_diagonal.size(); ++row) {
    const double m = mass_factor * system.mass_kg[m_pattern.node_of_row[row]];
    m_diagonal[row] = {m, m, m, 0, 0, 0};
  }
  m_coupling.assign(m_pattern.couplings.size(), SymmetricBlock{});
  for (std::size_t n = 0; n < system.springs.size(); ++n) {
    if (n % kSpringsPerPoll == 0) poll(progress);
    const Spring& s = system.springs[n];
    const SpringRows place = {m_pattern.row_of_node[s.a], m_pattern.row_of_node[s.b],
                              m_pattern.coupling_of_spring[n]};
    if (place.a < 0 && place.b < 0) continue;
    const Vec3d x = system.pos_mm[s.b] - system.pos_mm[s.a];
    const double length = std::sqrt(x.length2());
    if (length > 0) {
      const double across = std::max(0.0, 1 - s.rest_mm / length);
      add_block(place, spring_block(x / length, s.stiffness_n_m, across * s.stiffness_n_m));
    }
    if (damping_factor == 0 || s.damping_n_s_m == 0) continue;
    const Vec3d before = damping_pos[s.b] - damping_pos[s.a];
    const double length_before = std::sqrt(before.length2());
    if (length_before == 0) continue;
    add_block(place, spring_block(before / length_before, damping_factor * s.damping_n_s_m, 0));
  }
  add_barrier(system);
}

bool SpringMatrix::factorise(const SpringSystem& system, double mass_factor, double damping_factor,
                             const std::vector<Vec3d>& damping_pos,
                             const std::vector<PressedNode>& pressed, const Progress* progress) {
  assemble(system, mass_factor, damping_factor, damping_pos, progress);
  for (const PressedNode& node : pressed) {
    const int row = m_pattern.row_of_node[node.node];
    const SymmetricBlock& own = m_diagonal[row];
    add(m_diagonal[row], spring_block(node.normal, kFixing * (own[0] + own[1] + own[2]), 0), 1);
  }
  if (m_factors) return m_factors->factorise(m_diagonal, m_coupling);
  return m_gradients->prepare(m_diagonal, m_coupling);
}

void SpringMatrix::solve(std::vector<Vec3d>& x, double tolerance, const Progress* progress) {
  m_rows.resize(m_pattern.node_of_row.size());
  for (std::size_t row = 0; row < m_rows.size(); ++row) m_rows[row] = x[m_pattern.node_of_row[row]];
  if (m_factors) {
    m_factors->solve(m_rows);
  } else {
    m_gradients->solve(m_rows, tolerance, progress);
  }
  std::fill(x.begin(), x.end(), Vec3d(0.0));
  for (std::size_t row = 0; row < m_rows.size(); ++row) x[m_pattern.node_of_row[row]] = m_rows[row];
}

void SpringMatrix::take_back(std::vector<SlidingNode>& sliding) const {
  constexpr int kSweeps = 50;
  std::vector<int> place_of_row(m_diagonal.size(), -1);
  for (std::size_t n = 0; n < sliding.size(); ++n) {
    place_of_row[m_pattern.row_of_node[sliding[n].node]] = int(n);
  }
  std::vector<std::vector<std::array<int, 2>>> others(sliding.size());  // place, coupling
  for (std::size_t n = 0; n < m_coupling.size(); ++n) {
    const auto [row_a, row_b] = m_pattern.couplings[n];
    const int a = place_of_row[row_a], b = place_of_row[row_b];
    if (a < 0 || b < 0) continue;
    others[a].push_back({b, int(n)});
    others[b].push_back({a, int(n)});
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t n = 0; n < sliding.size(); ++n) {
      SlidingNode& node = sliding[n];
      const SymmetricBlock& own = m_diagonal[m_pattern.row_of_node[node.node]];
      Vec3d force = times(own, node.back_mm);
      for (const auto& [place, coupling] : others[n]) {
        force += times(m_coupling[coupling], sliding[place].back_mm);
      }
      force -= node.normal * node.normal.dot(force);
      const double stiffness = own[0] + own[1] + own[2] - node.normal.dot(times(own, node.normal));
      Vec3d slip = node.slip_mm + node.back_mm - force / stiffness;
      const double pull = stiffness * slip.length();
      slip *= pull > node.friction_mn ? 1 - node.friction_mn / pull : 0;
      node.back_mm = slip - node.slip_mm;
    }
  }
}

std::size_t SpringMatrix::bytes() const {
  return (m_factors ? m_factors->bytes() : 0) + (m_gradients ? m_gradients->bytes() : 0) +
         (m_diagonal.size() + m_coupling.size()) * sizeof(SymmetricBlock);
}

}  // namespace supple
