// The motion of a body in time (thesis eq. 3.9):
//
//   M u'' + D u' + K u = f,  D = alpha M + sum over elements of beta K,
//
// linear elasticity with Rayleigh damping, by Newmark's method with average acceleration (Newmark
// 1959, gamma = 1/2, beta = 1/4; Bathe 1996, section 9.2.4): stable for any step, exact to the
// second order in it, and without damping of its own. With the step h and
//
//   ~u = u + h u' + h^2/4 u'',  ~v = u' + h/2 u'',
//   (K + 2/h D + 4/h^2 M) w = f - K ~u - D ~v,
//
// the next displacement is ~u + w, the next velocity ~v + 2/h w, the next acceleration 4/h^2 w.
// Held components have their own law of motion; ~u and ~v are there what makes these equations
// true. Solved by conjugate gradients with the multigrid cycle, whose levels have the mass, too.
//
// Where nothing that is held moves, energy, work and what damping takes balance in every step but
// for the solver's residual.
//
// Cost of a step: one solution, whose iterations are fewer the smaller the step is, and four
// products. Memory: 48 bytes per unknown beside that of a solution.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "lib/fem/dynamics/mass.h"
#include "lib/fem/elastic_solid.h"
#include "lib/fem/fem_solution.h"

namespace supple {

struct RayleighDamping {
  double mass_per_s = 0;                             // alpha
  std::array<double, kLastClass + 1> stiffness_s{};  // beta, per class

  bool empty() const;
  /// Throws InputError: a value that is negative or not finite.
  void validate() const;
};

struct NewmarkParams {
  double step_s = 1e-3;
  /// Largest force that each system may leave on a node, relative to the largest there is.
  double tolerance = 1e-7;
  int max_iterations = 400;

  /// Throws InputError.
  void validate() const;
};

/// Part of its way that something has come, 0 to 1, and the derivatives of that by time.
struct WayPart {
  double part = 1, per_s = 0, per_s2 = 0;
};
/// Starts and ends with neither speed nor acceleration: s - sin(2 pi s) / 2 pi with s = time /
/// duration. At its end from the first on where the duration is 0.
WayPart smooth_way(double time_s, double duration_s);

class Newmark {
 public:
  /// `loads.held` components go from where they are at the start to `loads.u_mm`; forces act from
  /// the start on. `solid` must outlive this. Throws InputError as
  /// ElasticSolid::weighted() and validate(), Cancelled.
  Newmark(const ElasticSolid& solid, const MassDensities& density, const RayleighDamping& damping,
          NodalLoads loads, const NewmarkParams& params, Progress* progress = nullptr);

  /// Starts at these displacements and velocities, three per node, with the forces' acceleration.
  /// Held components are where `u_mm` has them, and at rest. Throws NotConverged, Cancelled.
  void start(std::vector<double> u_mm, std::vector<double> v_mm_s, Progress* progress = nullptr);
  /// Makes one step, at whose end what is held has come `way` along. Throws NotConverged,
  /// Cancelled; the motion is then where it was before.
  void step(const WayPart& way, const Progress* progress = nullptr);

  const std::vector<double>& u_mm() const { return m_u; }
  const std::vector<double>& v_mm_s() const { return m_v; }
  const std::vector<double>& a_mm_s2() const { return m_a; }
  /// f - K u - D u' - M u'': 0 but where components are held, with which the body pulls there, mN.
  const std::vector<double>& reaction_mn() const { return m_reaction; }
  const NodalLoads& loads() const { return m_loads; }
  MotionEnergy energy() const;

  double time_s() const { return m_step * m_params.step_s; }
  int steps() const { return m_step; }
  int iterations() const { return m_iterations; }         // of all steps
  double residual_max() const { return m_residual_max; }  // the largest of all steps
  int level_count() const { return m_system->level_count(); }
  std::size_t bytes() const;

 private:
  bool is_held(std::size_t n) const { return (m_loads.held[n / 3] >> n % 3 & 1) != 0; }
  void add_damping(const std::vector<double>& v, double factor, std::vector<double>& y) const;
  void find_acceleration(Progress* progress);
  void count_energy(const std::vector<double>& u_before, const std::vector<double>& v_before,
                    const std::vector<double>& reaction_before);

  const ElasticSolid& m_solid;
  NewmarkParams m_params;
  NodalLoads m_loads;
  std::vector<double> m_from;                   // where held components began
  std::unique_ptr<Operator> m_mass, m_damping;  // M, and D where there is any
  std::unique_ptr<LinearSystem> m_system;       // K + 2/h D + 4/h^2 M
  std::vector<double> m_u, m_v, m_a, m_reaction;
  int m_step = 0, m_iterations = 0;
  double m_residual_max = 0, m_work_mj = 0, m_dissipated_mj = 0;
  std::size_t m_solver_bytes = 0;
};

}  // namespace supple
