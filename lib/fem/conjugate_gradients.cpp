#include "lib/fem/conjugate_gradients.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

/// The residual is computed afresh after it seemed small enough, or where a cycle that is not quite
/// linear gave no descent; iterations start again from there.
constexpr int kMaxStarts = 20;

/// Of single nodes, by ranges.
struct NodeNorms {
  double largest_free = 0, largest_held = 0, squares = 0;
};

NodeNorms norms_of_range(const double* r, const std::uint8_t* held, std::size_t begin,
                         std::size_t end) {
  NodeNorms norms;
  for (std::size_t n = begin / 3; n < end / 3; ++n) {
    double free = 0, reaction = 0;
    for (int a = 0; a < 3; ++a) {
      const double square = r[3 * n + a] * r[3 * n + a];
      ((held[n] >> a & 1) != 0 ? reaction : free) += square;
    }
    norms.largest_free = std::max(norms.largest_free, free);
    norms.largest_held = std::max(norms.largest_held, reaction);
    norms.squares += free;
  }
  return norms;
}

NodeNorms node_norms(const std::vector<double>& r, const HeldBits& held) {
  static_assert(kVectorRange % 3 == 0, "ranges hold whole nodes");
  std::vector<NodeNorms> parts((r.size() + kVectorRange - 1) / kVectorRange);
  for_ranges(r.size(), [&](std::size_t begin, std::size_t end) {
    parts[begin / kVectorRange] = norms_of_range(r.data(), held.data(), begin, end);
  });
  NodeNorms sum;
  for (const NodeNorms& part : parts) {
    sum.largest_free = std::max(sum.largest_free, part.largest_free);
    sum.largest_held = std::max(sum.largest_held, part.largest_held);
    sum.squares += part.squares;
  }
  return {std::sqrt(sum.largest_free), std::sqrt(sum.largest_held), sum.squares};
}

}  // namespace

ConjugateGradients::ConjugateGradients(const HexOperator& stiffness, Multigrid& multigrid,
                                       NodalLoads& loads, const FemParams& params)
    : m_stiffness(&stiffness),
      m_multigrid(&multigrid),
      m_loads(&loads),
      m_params(params),
      m_u(std::move(loads.u_mm)),
      m_r(m_u.size()),
      m_p(m_u.size()),
      m_shared(m_u.size()) {
  if (!loads.force_mn.empty()) {
    const NodeNorms norms = node_norms(loads.force_mn, loads.held);
    m_largest_load_mn = std::max(norms.largest_free, norms.largest_held);
  }
  m_reactions.resize(loads.nodes_of.size(), Vec3d(0));
}

std::size_t ConjugateGradients::bytes() const {
  return (2 * m_u.capacity() + m_loads->force_mn.capacity()) * sizeof(double) +
         m_p.capacity() * sizeof(float) + m_shared.bytes() + m_loads->held.capacity();
}

/// r = f - K u.
void ConjugateGradients::compute_residual() {
  if (m_loads->force_mn.empty()) {
    fill(m_r.data(), m_r.size(), 0.0);
  } else {
    std::copy(m_loads->force_mn.begin(), m_loads->force_mn.end(), m_r.begin());
  }
  m_stiffness->subtract(m_u.data(), m_r.data());
}

void ConjugateGradients::measure() {
  const NodeNorms norms = node_norms(m_r, m_loads->held);
  m_largest_residual_mn = norms.largest_free;
  m_state.largest_force_mn = std::max(m_largest_load_mn, norms.largest_held);
  const double scale = m_state.largest_force_mn > 0 ? 1 / m_state.largest_force_mn : 0;
  m_state.residual_max = norms.largest_free * scale;
  m_state.residual_rms = std::sqrt(norms.squares / double(m_loads->held.size())) * scale;
  double change = 0, largest = 0;
  for (std::size_t s = 0; s < m_reactions.size(); ++s) {
    Vec3d sum(0);
    for (const NodeIndex n : m_loads->nodes_of[s]) {
      for (int a = 0; a < 3; ++a) {
        if ((m_loads->held[n] >> a & 1) != 0) sum[a] += m_r[3 * std::size_t(n) + a];
      }
    }
    change = std::max(change, (sum - m_reactions[s]).length());
    largest = std::max(largest, sum.length());
    m_reactions[s] = sum;
  }
  // Reactions that balance each other to rounding count by the largest nodal force.
  largest = std::max(largest, m_state.largest_force_mn);
  m_state.reaction_change = largest > 0 ? change / largest : 0;
}

bool ConjugateGradients::is_converged() const {
  return std::max(m_state.residual_max, m_state.residual_rms) <= m_params.tolerance &&
         m_state.reaction_change <= m_params.reaction_tolerance;
}

/// z = B r in single precision, scaled so that neither large nor small forces leave its range.
void ConjugateGradients::precondition() {
  const double scale = m_largest_residual_mn > 0 ? 1 / m_largest_residual_mn : 1;
  float* r = m_shared.first();
  for_ranges(m_r.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const bool is_held = (m_loads->held[n / 3] >> n % 3 & 1) != 0;
      r[n] = is_held ? 0.0f : float(m_r[n] * scale);
    }
  });
  m_multigrid->cycle(r, m_shared.second());
}

/// One step; false where rounding leaves no descent.
bool ConjugateGradients::iterate(bool is_first) {
  const float* z = m_shared.second();
  const double beta = is_first ? 0 : -dot(z, m_shared.third(), m_p.size()) / m_p_q;
  for_ranges(m_p.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      m_p[n] = is_first ? z[n] : float(z[n] + beta * m_p[n]);
    }
  });
  double* q = m_shared.one();
  fill(q, m_p.size(), 0.0);
  m_stiffness->add(m_p.data(), q);
  m_p_q = dot(m_p.data(), q, m_p.size());
  const double r_p = dot(m_r.data(), m_p.data(), m_p.size());
  if (!(r_p > 0) || !(m_p_q > 0)) return false;
  const double alpha = r_p / m_p_q;
  float* q_single = m_shared.third();
  for_ranges(m_p.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      m_u[n] += alpha * m_p[n];
      m_r[n] -= alpha * q[n];
      q_single[n] = float(q[n]);
    }
  });
  return true;
}

bool ConjugateGradients::run(Progress* progress) {
  compute_residual();
  measure();
  if (m_largest_residual_mn == 0) return true;
  for (int start = 0; start < kMaxStarts; ++start) {
    bool is_first = true;
    while (m_state.iterations < m_params.max_iterations) {
      poll(progress);
      precondition();
      if (!iterate(is_first)) break;
      is_first = false;
      ++m_state.iterations;
      measure();
      if (is_converged()) break;
    }
    const double change = m_state.reaction_change;
    compute_residual();
    measure();
    m_state.reaction_change = change;
    if (is_converged()) return true;
    if (m_state.iterations >= m_params.max_iterations) break;
  }
  return false;
}

}  // namespace supple
