// Extended position-based dynamics (M. Macklin, M. Mueller, N. Chentanez, XPBD, 2016): springs as
// constraints of compliance 1 / k, solved by Gauss-Seidel sweeps in the order of the springs, every
// second one backwards. Per spring with multiplier lambda, step h and w = 1/m_a + 1/m_b,
//   d_lambda = -(h^2 k C + h d n.(dx_b - dx_a) + lambda) / (1 + (h^2 k + h d) w),  C = |x| - R,
// which is the paper's equation 26 times h^2 k, so that k = 0 and k without bound are no
// exceptions.
//
// Every substep starts with multipliers of 0, and the residual that sweeps leave makes the body
// softer than it is. By how much depends on h^2 omega^2 + h gamma alone (stability.h), not on the
// size of the body. With four sweeps cubes of 6^3 and 14^3 voxels under their weight, soft or half
// of them hard, damped or not, sank too far by at most 2 % at 10, 22 % at 30 and 123 % at 100. The
// number of substeps therefore follows from stiffnesses, masses and the step; a fixed one keeps the
// price fixed and is soft. A single sweep per substep carries stretch one way only: dragged, the
// membrane of `supple bench springs` then reached 1.04 to 1.5 times the energy that it reached with
// two. Less than two are refused.
#pragma once

#include "lib/springs/integrator.h"

namespace supple {

class Xpbd final : public SpringIntegrator {
 public:
  struct Params {
    int substeps = 0;         // 0: as many as four sweeps solve to 2 %, at least 8
    int sweeps = 4;           // per substep, at least 2
    int max_substeps = 1000;  // more are refused
  };
  /// Throws InputError as validate(system), for negative substeps or less than two sweeps.
  Xpbd(SpringSystem& system, const Params& params, const Progress* progress = nullptr);
  explicit Xpbd(SpringSystem& system, const Progress* progress = nullptr)
      : Xpbd(system, Params(), progress) {}

  /// Longest substep that four sweeps solve to 2 %, in s.
  double longest_substep_s() const { return m_longest_substep_s; }

 private:
  /// Throws InputError naming the step that would do when too many substeps are needed.
  SpringStepReport advance(double dt_s) override;
  int substeps_of(double dt_s) const;
  void sweep(double h, bool forwards);
  int solve_spring(std::size_t n, double h);
  void solve_corner(std::size_t n, double h);
  ContactReport touch_shapes(double h);
  void add_held_forces(double h, double weight);

  Params m_params;
  double m_longest_substep_s;
  std::vector<double> m_inverse_mass;       // 0 at held nodes
  std::vector<double> m_multiplier;         // per spring, in kg mm: force times h^2
  std::vector<double> m_corner_multiplier;  // per awake corner of the barrier, the same
  std::vector<Vec3d> m_start;
  std::vector<Vec3d> m_held_push;  // per node: impulse of the sweeps on held ones, in kg mm
  double m_slowing = 1;
  int m_without_direction = 0;
};

}  // namespace supple
