// Extended position-based dynamics (M. Macklin, M. Mueller, N. Chentanez, XPBD, 2016): springs as
// constraints of compliance 1 / k, solved by Gauss-Seidel sweeps in the order of the springs, every
// second one backwards. Per spring with multiplier lambda, step h and w = 1/m_a + 1/m_b,
//   d_lambda = -(h^2 k C + h d n.(dx_b - dx_a) + lambda) / (1 + (h^2 k + h d) w),  C = |x| - R,
// which is the paper's equation 26 times h^2 k, so that k = 0 and k without bound are no
// exceptions.
//
// Stable for any step and stiffness at a fixed price; what sweeps leave unsolved makes stiff bodies
// softer than they are, and the forces at held nodes are those of the softer body. A single sweep
// per substep carries stretch one way only: dragged, the membrane of `supple bench springs` then
// reached 1.04 to 1.5 times the energy that it reached with two. Less than two are refused.
#pragma once

#include "lib/springs/integrator.h"

namespace supple {

class Xpbd final : public SpringIntegrator {
 public:
  struct Params {
    int substeps = 8;
    int sweeps = 4;  // per substep, at least 2
  };
  /// Throws InputError as validate(system), for less than one substep or two sweeps.
  Xpbd(SpringSystem& system, const Params& params);
  explicit Xpbd(SpringSystem& system) : Xpbd(system, Params()) {}

 private:
  SpringStepReport advance(double dt_s) override;
  void sweep(double h, bool forwards);
  int solve_spring(std::size_t n, double h);
  ContactReport touch_shapes(double h);
  void add_held_forces(double h, double weight);

  Params m_params;
  std::vector<double> m_inverse_mass;  // 0 at held nodes
  std::vector<double> m_multiplier;    // per spring, in kg mm: force times h^2
  std::vector<Vec3d> m_start;
  std::vector<Vec3d> m_held_push;  // per node: what sweeps would have done to held ones, in kg mm
  double m_slowing = 1;
  int m_without_direction = 0;
};

}  // namespace supple
