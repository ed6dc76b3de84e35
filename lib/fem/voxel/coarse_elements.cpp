#include "lib/fem/voxel/coarse_elements.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

/// Single precision reaches no less before the residual is computed afresh. Once that is small
/// enough a few steps more tell by how much reactions still change.
constexpr double kLeastPart = 1e-5, kMostPart = 0.1;
/// Part of the tolerance that is aimed at.
constexpr double kMargin = 0.3;
/// P^T r is rounded by this part of the largest nodal force: forces of the voxels do not vanish,
/// only their sums do.
constexpr double kRounding = 3e-7;

}  // namespace

CoarseElements::CoarseElements(const HexOperator& stiffness, Multigrid& multigrid, int level,
                               NodalLoads& loads, const CgLimits& limits)
    : m_stiffness(&stiffness),
      m_multigrid(&multigrid),
      m_level(level),
      m_loads(&loads),
      m_limits(limits),
      m_meter(loads),
      m_u(std::move(loads.u_mm)),
      m_r(m_u.size()),
      m_single(m_u.size()) {}

std::size_t CoarseElements::bytes() const {
  return (2 * m_u.capacity() + m_loads->force_mn.capacity()) * sizeof(double) +
         m_single.capacity() * sizeof(float) + m_loads->held.capacity();
}

/// r = f - K u, and its forces on the coarse nodes, scaled so that single precision has room.
void CoarseElements::measure_residual() {
  set_to_forces(*m_loads, m_r);
  m_stiffness->subtract(m_u.data(), m_r.data());
  m_size = m_meter(m_r);
  m_scale = m_size.largest_mn > 0 ? 1 / m_size.largest_mn : 1;
  for_ranges(m_r.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) m_single[n] = float(m_r[n] * m_scale);
  });
  const std::vector<float>& forces = m_multigrid->restrict_to(m_level, m_single.data());
  double largest = 0, squares = 0;
  for (std::size_t n = 0; n < forces.size(); n += 3) {
    const double square = double(forces[n]) * forces[n] + double(forces[n + 1]) * forces[n + 1] +
                          double(forces[n + 2]) * forces[n + 2];
    largest = std::max(largest, square);
    squares += square;
  }
  m_size.largest_mn = std::sqrt(largest) / m_scale;
  const double part = m_size.largest_force_mn > 0 ? 1 / (m_scale * m_size.largest_force_mn) : 0;
  m_size.max = std::sqrt(largest) * part;
  m_size.rms = std::sqrt(3 * squares / double(std::max<std::size_t>(forces.size(), 3))) * part;
}

bool CoarseElements::run(const Progress* progress, Progress* told) {
  const double tolerance = std::max(m_limits.tolerance, kRounding);
  for (;;) {
    measure_residual();
    if (m_size.is_within(tolerance, m_limits.reaction_tolerance)) return true;
    if (m_iterations >= m_limits.max_iterations) return false;
    if (told != nullptr) {
      told->update(part_of_way(m_size, tolerance, m_limits.reaction_tolerance));
    }
    const double part = std::clamp(kMargin * tolerance / m_size.max, kLeastPart, kMostPart);
    const int steps =
        m_multigrid->solve_at(m_level, part, m_limits.max_iterations - m_iterations, progress);
    if (steps == 0) return false;
    m_iterations += steps;
    m_multigrid->prolong_from(m_level, m_single.data());
    for_ranges(m_u.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) m_u[n] += m_single[n] / m_scale;
    });
  }
}

}  // namespace supple
