#include "lib/fem/conjugate_gradients.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

/// The residual is computed afresh after it seemed small enough, or where a cycle that is not quite
/// linear gave no descent; iterations start again from there.
constexpr int kMaxStarts = 20;

}  // namespace

ConjugateGradients::ConjugateGradients(LinearSystem& system, NodalLoads& loads,
                                       const CgLimits& limits)
    : m_system(&system),
      m_loads(&loads),
      m_limits(limits),
      m_meter(loads),
      m_u(std::move(loads.u_mm)),
      m_r(m_u.size()),
      m_p(m_u.size()),
      m_shared(m_u.size()) {
  if (limits.error_mm > 0) m_error.emplace(loads.held, limits.contrast, limits.ritz_value);
}

std::size_t ConjugateGradients::bytes() const {
  return (2 * m_u.capacity() + m_loads->force_mn.capacity()) * sizeof(double) +
         m_p.capacity() * sizeof(float) + m_shared.bytes() + m_loads->held.capacity() +
         (m_error ? m_error->bytes() : 0);
}

/// r = f - K u.
void ConjugateGradients::compute_residual() {
  set_to_forces(*m_loads, m_r);
  m_system->subtract(m_u.data(), m_r.data());
}

bool ConjugateGradients::is_converged() const {
  if (m_size.largest_mn <= m_limits.residual_mn) return true;
  return m_size.is_within(m_limits.tolerance, m_limits.reaction_tolerance) &&
         (!m_error || m_error->error_mm() <= m_limits.error_mm || m_size.is_rounding());
}

std::optional<double> ConjugateGradients::error_mm() const {
  if (!m_error) return std::nullopt;
  return m_size.is_rounding() ? 0 : m_error->error_mm();
}

/// z = B r in single precision, scaled so that neither large nor small forces leave its range.
void ConjugateGradients::precondition(const Progress* progress) {
  const double scale = m_size.largest_mn > 0 ? 1 / m_size.largest_mn : 1;
  float* r = m_shared.first();
  for_ranges(m_r.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const bool is_held = (m_loads->held[n / 3] >> n % 3 & 1) != 0;
      r[n] = is_held ? 0.0f : float(m_r[n] * scale);
    }
  });
  m_system->precondition(r, m_shared.second(), progress);
  m_step.beta = m_scale / scale;
  m_scale = scale;
}

/// Does one step; false where rounding leaves no descent.
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
  m_system->add(m_p.data(), q);
  m_p_q = dot(m_p.data(), q, m_p.size());
  const double r_p = dot(m_r.data(), m_p.data(), m_p.size());
  const bool is_first_and_negative = m_limits.may_be_indefinite && is_first && m_p_q < 0;
  if (!(r_p > 0) || (!(m_p_q > 0) && !is_first_and_negative)) return false;
  const double alpha = r_p / std::abs(m_p_q);
  m_step = {alpha * m_scale, beta * m_step.beta};
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

/// A residual may grow on its way; what is told does not go back.
void ConjugateGradients::tell(Progress* told) {
  if (told == nullptr) return;
  double part = part_of_way(m_size, m_limits.tolerance, m_limits.reaction_tolerance);
  if (m_error && std::isfinite(m_first_error_mm)) {
    part = std::min(part, decades_done(m_error->error_mm() / m_first_error_mm,
                                       m_limits.error_mm / m_first_error_mm));
  }
  m_told_part = std::max(m_told_part, part);
  told->update(m_told_part);
}

bool ConjugateGradients::run(const Progress* progress, Progress* told) {
  if (!m_goes_on) {
    compute_residual();
    m_size = m_meter(m_r);
    if (m_size.largest_mn == 0) return true;
  }
  for (; m_starts < kMaxStarts; ++m_starts) {
    if (m_error && !m_goes_on) m_error->start(m_u);
    while (m_iterations < m_limits.max_iterations) {
      poll(progress);
      precondition(progress);
      if (!iterate(!m_goes_on)) break;
      m_goes_on = true;
      ++m_iterations;
      m_size = m_meter(m_r);
      if (m_error) m_error->take(m_u, m_step);
      if (m_iterations == 1 && m_error) m_first_error_mm = m_error->error_mm();
      tell(told);
      if (is_converged() || !(m_p_q > 0)) break;
    }
    const double change = m_size.reaction_change;
    compute_residual();
    m_size = m_meter(m_r);
    m_size.reaction_change = change;
    if (is_converged()) return true;
    if (m_iterations >= m_limits.max_iterations) return false;
    if (!m_goes_on || m_limits.may_be_indefinite) return false;
    m_goes_on = false;
  }
  return false;
}

}  // namespace supple
