#include "lib/springs/projective.h"

#include <cmath>
#include <string>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {

struct ProjectiveDynamics::Solver {
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factors;
  Eigen::Matrix<double, Eigen::Dynamic, 3> right, x;
  bool is_analysed = false;
};

ProjectiveDynamics::ProjectiveDynamics(SpringSystem& system, const Params& params)
    : SpringIntegrator(system),
      m_params(params),
      m_row(system.node_count(), -1),
      m_solver(std::make_unique<Solver>()) {
  if (params.iterations < 1) {
    throw InputError({"", "projective dynamics", std::to_string(params.iterations) + " iterations",
                      "at least one"});
  }
  int rows = 0;
  for (std::size_t n = 0; n < system.node_count(); ++n) {
    if (!m_is_held[n]) m_row[n] = rows++;
  }
  m_solver->right.resize(rows, 3);
}

ProjectiveDynamics::~ProjectiveDynamics() = default;

void ProjectiveDynamics::factorise(double dt_s) {
  const double alpha = m_system.mass_damping_per_s;
  if (dt_s == m_factorised_dt_s && alpha == m_factorised_alpha) return;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t n = 0; n < m_row.size(); ++n) {
    if (m_row[n] < 0) continue;
    const double inertia = m_system.mass_kg[n] * (1 / (dt_s * dt_s) + alpha / dt_s);
    entries.emplace_back(m_row[n], m_row[n], inertia);
  }
  for (const Spring& s : m_system.springs) {
    const double weight = s.stiffness_n_m + s.damping_n_s_m / dt_s;
    const int a = m_row[s.a], b = m_row[s.b];
    if (a >= 0) entries.emplace_back(a, a, weight);
    if (b >= 0) entries.emplace_back(b, b, weight);
    if (a >= 0 && b >= 0) entries.emplace_back(std::max(a, b), std::min(a, b), -weight);
  }
  Eigen::SparseMatrix<double> matrix(m_solver->right.rows(), m_solver->right.rows());
  matrix.setFromTriplets(entries.begin(), entries.end());
  if (!m_solver->is_analysed) m_solver->factors.analyzePattern(matrix);
  m_solver->is_analysed = true;
  m_solver->factors.factorize(matrix);
  if (m_solver->factors.info() != Eigen::Success) {
    throw InputError({"", "projective dynamics", "a matrix that is not positive definite",
                      "masses and stiffnesses whose ratio a double can hold"});
  }
  m_factorised_dt_s = dt_s;
  m_factorised_alpha = alpha;
}

void ProjectiveDynamics::project_springs(double dt_s) {
  m_without_direction = 0;
  for (std::size_t n = 0; n < m_system.springs.size(); ++n) {
    const Spring& s = m_system.springs[n];
    const Vec3d x = m_system.pos_mm[s.b] - m_system.pos_mm[s.a];
    const double length = std::sqrt(x.length2());
    Vec3d goal(0.0);
    if (length > 0) {
      goal = x * (s.stiffness_n_m * s.rest_mm / length);
    } else {
      ++m_without_direction;
    }
    if (s.damping_n_s_m > 0) {
      const Vec3d before = m_start[s.b] - m_start[s.a];
      const double length2 = before.length2();
      Vec3d allowed = x;
      if (length2 > 0) allowed -= before * (before.dot(x - before) / length2);
      goal += allowed * (s.damping_n_s_m / dt_s);
    }
    m_goal[n] = goal;
  }
}

SpringStepReport ProjectiveDynamics::advance(double dt_s) {
  SpringStepReport report;
  report.substeps = 1;
  report.iterations = m_params.iterations;
  factorise(dt_s);
  m_start = m_system.pos_mm;
  m_goal.resize(m_system.springs.size());
  // Inertia, weight and mass damping: the part of the right-hand side that the start gives.
  m_inertia.resize(m_system.node_count());
  const double alpha = m_system.mass_damping_per_s;
  for (std::size_t n = 0; n < m_system.node_count(); ++n) {
    const Vec3d& v = m_system.velocity_mm_s[n];
    m_inertia[n] = (m_start[n] * (1 / (dt_s * dt_s) + alpha / dt_s) + v / dt_s +
                    m_system.gravity_m_s2 * kMmPerM) *
                   m_system.mass_kg[n];
    if (!m_is_held[n]) m_system.pos_mm[n] += v * dt_s;
  }
  place_held(1);
  auto& right = m_solver->right;
  const auto add = [&](int row, const Vec3d& value) {
    if (row < 0) return;
    for (int c = 0; c < 3; ++c) right(row, c) += value[c];
  };
  for (int iteration = 0; iteration < m_params.iterations; ++iteration) {
    poll(progress());
    project_springs(dt_s);
    right.setZero();
    for (std::size_t n = 0; n < m_row.size(); ++n) add(m_row[n], m_inertia[n]);
    for (std::size_t n = 0; n < m_system.springs.size(); ++n) {
      const Spring& s = m_system.springs[n];
      const double weight = s.stiffness_n_m + s.damping_n_s_m / dt_s;
      const int a = m_row[s.a], b = m_row[s.b];
      add(b, m_goal[n]);
      add(a, -m_goal[n]);
      if (a < 0) add(b, m_system.pos_mm[s.a] * weight);
      if (b < 0) add(a, m_system.pos_mm[s.b] * weight);
    }
    m_solver->x = m_solver->factors.solve(right);
    for (std::size_t n = 0; n < m_row.size(); ++n) {
      if (m_row[n] < 0) continue;
      for (int c = 0; c < 3; ++c) m_system.pos_mm[n][c] = m_solver->x(m_row[n], c);
    }
  }
  report.without_direction = m_without_direction;
  // Forces of the last solve, which balance the nodes' momentum exactly.
  m_inertia.assign(m_system.node_count(), Vec3d(0.0));
  for (std::size_t n = 0; n < m_system.springs.size(); ++n) {
    const Spring& s = m_system.springs[n];
    if (!m_is_held[s.a] && !m_is_held[s.b]) continue;
    const double weight = s.stiffness_n_m + s.damping_n_s_m / dt_s;
    const Vec3d on_a = (m_system.pos_mm[s.b] - m_system.pos_mm[s.a]) * weight - m_goal[n];
    m_inertia[s.a] += on_a;
    m_inertia[s.b] -= on_a;
  }
  for (const HeldNode& held : m_system.held) {
    m_inertia[held.node] +=
        (m_system.gravity_m_s2 * kMmPerM - m_system.velocity_mm_s[held.node] * alpha) *
        m_system.mass_kg[held.node];
  }
  add_reactions(m_inertia, 1);
  for (std::size_t n = 0; n < m_row.size(); ++n) {
    if (m_row[n] >= 0) m_system.velocity_mm_s[n] = (m_system.pos_mm[n] - m_start[n]) / dt_s;
  }
  end_contacts(m_start, dt_s, report);
  return report;
}

}  // namespace supple
