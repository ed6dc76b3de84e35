#include "lib/fem/dynamics/newmark.h"

#include <algorithm>
#include <cmath>

#include "lib/fem/conjugate_gradients.h"
#include "lib/fem/node_vectors.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

constexpr double kWholeTurn = 2 * kPi;
/// Reactions do not count beside the residual.
constexpr double kAnyChange = 1e300;
/// Part of the largest force that the first acceleration may leave.
constexpr double kStartTolerance = 1e-10;

/// M with the inverse of its diagonal as preconditioner, whose condition does not depend on the
/// size of the body.
class MassSystem final : public LinearSystem {
 public:
  MassSystem(const Operator& mass, const HeldBits& held)
      : m_mass(mass), m_held(held), m_diagonal(mass.diagonal()) {}

  void add(const float* x, double* y) const override { m_mass.add(x, y); }
  void subtract(const double* x, double* y) const override { m_mass.subtract(x, y); }
  void precondition(float* r, float* z, const Progress*) override {
    for_ranges(m_diagonal.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        const bool is_held = (m_held[n / 3] >> n % 3 & 1) != 0;
        z[n] = is_held ? 0.0f : r[n] / m_diagonal[n];
      }
    });
  }

 private:
  const Operator& m_mass;
  const HeldBits& m_held;
  std::vector<float> m_diagonal;
};

FemReport report_of(const ConjugateGradients& solver) {
  FemReport report;
  report.unknowns = std::int64_t(solver.u().size());
  report.iterations = solver.iterations();
  report.residual_max = solver.size().max;
  report.residual_rms = solver.size().rms;
  return report;
}

/// x = f(n) for every component.
template <class ValueOf>
void set_all(std::vector<double>& x, ValueOf&& value_of) {
  for_ranges(x.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) x[n] = value_of(n);
  });
}

template <class TermOf>
double sum_of(std::size_t count, TermOf&& term_of) {
  return sum_ranges(count, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t n = begin; n < end; ++n) sum += term_of(n);
    return sum;
  });
}

}  // namespace

bool RayleighDamping::empty() const {
  return mass_per_s == 0 && std::all_of(stiffness_s.begin(), stiffness_s.end(),
                                        [](double value) { return value == 0; });
}

void RayleighDamping::validate() const {
  const auto require = [](double value, const char* field) {
    if (value >= 0 && std::isfinite(value)) return;
    throw InputError({"", field, number_text(value), "0 or above"});
  };
  require(mass_per_s, "mass_damping");
  for (const double value : stiffness_s) require(value, "damping");
}

void NewmarkParams::validate() const {
  if (!(step_s > 0) || !std::isfinite(step_s)) {
    throw InputError({"", "step", number_text(step_s), "above 0 s"});
  }
  if (!(tolerance > 0 && tolerance < 1)) {
    throw InputError({"", "tolerance", number_text(tolerance), "between 0 and 1"});
  }
  if (max_iterations < 1) {
    throw InputError({"", "max_iterations", std::to_string(max_iterations), "at least 1"});
  }
}

WayPart smooth_way(double time_s, double duration_s) {
  if (time_s >= duration_s) return {};
  const double turn = kWholeTurn * std::max(0.0, time_s) / duration_s;
  return {(turn - std::sin(turn)) / kWholeTurn, (1 - std::cos(turn)) / duration_s,
          kWholeTurn * std::sin(turn) / (duration_s * duration_s)};
}

namespace {

ClassParts parts_of_system(const RayleighDamping& damping, double step_s) {
  ClassParts parts;
  for (std::size_t n = 0; n < parts.size(); ++n) {
    parts[n] = 1 + 2 / step_s * damping.stiffness_s[n];
  }
  return parts;
}

}  // namespace

Newmark::Newmark(const ElasticSolid& solid, const MassDensities& density,
                 const RayleighDamping& damping, NodalLoads loads, const NewmarkParams& params,
                 Progress* progress)
    : m_solid(solid), m_params(params), m_loads(std::move(loads)) {
  params.validate();
  damping.validate();
  m_mass = solid.weighted({density, even_parts(0), 1});
  if (!damping.empty()) {
    m_damping = solid.weighted({density, damping.stiffness_s, damping.mass_per_s});
  }
  const double step_s = params.step_s;
  const ElementWeights of_system{density, parts_of_system(damping, step_s),
                                 (4 / step_s + 2 * damping.mass_per_s) / step_s};
  m_system = solid.system(&of_system, m_loads.held, progress);
}

std::size_t Newmark::bytes() const {
  const std::size_t values = m_u.capacity() + m_v.capacity() + m_a.capacity() +
                             m_reaction.capacity() + m_from.capacity() + m_loads.u_mm.capacity();
  return values * sizeof(double) + m_mass->bytes() + (m_damping ? m_damping->bytes() : 0) +
         m_system->bytes() + m_solver_bytes;
}

/// y += factor D v.
void Newmark::add_damping(const std::vector<double>& v, double factor,
                          std::vector<double>& y) const {
  if (!m_damping) return;
  std::vector<double> force(v.size(), 0.0);
  m_damping->add(v.data(), force.data());
  set_all(y, [&](std::size_t n) { return y[n] + factor * force[n]; });
}

void Newmark::start(std::vector<double> u_mm, std::vector<double> v_mm_s, Progress* progress) {
  m_u = std::move(u_mm);
  m_v = std::move(v_mm_s);
  set_all(m_v, [&](std::size_t n) { return is_held(n) ? 0 : m_v[n]; });
  m_from = m_u;
  m_step = m_iterations = 0;
  m_residual_max = m_work_mj = m_dissipated_mj = 0;
  find_acceleration(progress);
}

/// M a = f - K u - D v, a = 0 where components are held.
void Newmark::find_acceleration(Progress* progress) {
  NodalLoads system;
  system.held = m_loads.held;
  system.u_mm.assign(m_u.size(), 0.0);
  system.force_mn = m_loads.force_mn;
  system.force_mn.resize(m_u.size(), 0.0);
  m_solid.matrix().subtract(m_u.data(), system.force_mn.data());
  add_damping(m_v, -1, system.force_mn);
  MassSystem mass(*m_mass, system.held);
  ConjugateGradients solver(mass, system, {kStartTolerance, kAnyChange, m_params.max_iterations});
  if (!solver.run(progress)) throw NotConverged(report_of(solver));
  m_reaction = solver.residual();
  m_a = solver.take_u();
}

void Newmark::step(const WayPart& way, const Progress* progress) {
  const double h = m_params.step_s, mass_part = 4 / (h * h);
  const auto way_of = [&](std::size_t n) { return m_loads.u_mm[n] - m_from[n]; };
  NodalLoads system;
  system.held = m_loads.held;
  system.u_mm.resize(m_u.size());
  set_all(system.u_mm, [&](std::size_t n) {
    return (is_held(n) ? way_of(n) * way.per_s2 : m_a[n]) / mass_part;
  });
  std::vector<double> u(m_u.size()), v(m_u.size());
  set_all(u, [&](std::size_t n) {
    return is_held(n) ? m_from[n] + way.part * way_of(n) - system.u_mm[n]
                      : m_u[n] + h * m_v[n] + m_a[n] / mass_part;
  });
  set_all(v, [&](std::size_t n) {
    return is_held(n) ? way.per_s * way_of(n) - 2 / h * system.u_mm[n] : m_v[n] + h / 2 * m_a[n];
  });
  system.force_mn = m_loads.force_mn;
  system.force_mn.resize(m_u.size(), 0.0);
  m_solid.matrix().subtract(u.data(), system.force_mn.data());
  add_damping(v, -1, system.force_mn);
  ConjugateGradients solver(*m_system, system,
                            {m_params.tolerance, kAnyChange, m_params.max_iterations});
  const bool converged = solver.run(progress);
  m_solver_bytes = solver.bytes() + 2 * u.capacity() * sizeof(double);
  m_residual_max = std::max(m_residual_max, solver.size().max);
  if (!converged) throw NotConverged(report_of(solver));
  m_iterations += solver.iterations();
  const std::vector<double>& w = solver.u();
  set_all(m_a, [&](std::size_t n) { return mass_part * w[n]; });
  set_all(u, [&](std::size_t n) { return u[n] + w[n]; });
  set_all(v, [&](std::size_t n) { return v[n] + 2 / h * w[n]; });
  u.swap(m_u);
  v.swap(m_v);
  std::vector<double> reaction = solver.residual();
  reaction.swap(m_reaction);
  count_energy(u, v, reaction);
  ++m_step;
}

/// Adds energies by means over the step, which are exact for average acceleration.
void Newmark::count_energy(const std::vector<double>& u_before, const std::vector<double>& v_before,
                           const std::vector<double>& reaction_before) {
  const bool has_forces = !m_loads.force_mn.empty();
  m_work_mj += kMjPerUj * sum_of(m_u.size(), [&](std::size_t n) {
                 double force = has_forces ? m_loads.force_mn[n] : 0;
                 if (is_held(n)) force -= (reaction_before[n] + m_reaction[n]) / 2;
                 return force * (m_u[n] - u_before[n]);
               });
  if (!m_damping) return;
  std::vector<double> mean(m_v.size()), force(m_v.size(), 0.0);
  set_all(mean, [&](std::size_t n) { return (m_v[n] + v_before[n]) / 2; });
  m_damping->add(mean.data(), force.data());
  m_dissipated_mj += kMjPerUj * m_params.step_s * dot(mean.data(), force.data(), mean.size());
}

MotionEnergy Newmark::energy() const {
  std::vector<double> force(m_u.size(), 0.0);
  MotionEnergy energy;
  m_solid.matrix().add(m_u.data(), force.data());
  energy.elastic_mj = kMjPerUj / 2 * dot(m_u.data(), force.data(), m_u.size());
  fill(force.data(), force.size(), 0.0);
  m_mass->add(m_v.data(), force.data());
  energy.kinetic_mj = kMjPerUj / 2 * dot(m_v.data(), force.data(), m_v.size());
  energy.work_mj = m_work_mj;
  energy.dissipated_mj = m_dissipated_mj;
  return energy;
}

}  // namespace supple
