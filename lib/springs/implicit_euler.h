// Implicit Euler: the positions that minimise the incremental potential of a step of h,
//   Phi(x) = 1/(2 h^2) |x - x_0 - h v_0|^2_M + U(x) - m g.x
//            + 1/(2 h) sum d (n_0.(dx_b - dx_a))^2 + alpha/(2 h) |x - x_0|^2_M,
// by Newton's method with a line search; v = (x - x_0) / h. One Newton step is the linearised
// method of Baraff and Witkin (Large steps in cloth simulation, 1998). Stable for any step; damps
// motions that are faster than the step. n_0 are the springs' directions at the start, so that
// damping never adds energy.
//
// Shapes bound the minimum: nodes on a surface that the forces press into it are fixed along its
// normal within a Newton step, and every trial of the line search is projected out of the shapes
// (D. Bertsekas, Projected Newton methods for optimization problems with simple constraints, 1982).
// Pressed nodes that a step moves along a curved surface are put back onto it. So their neighbours
// feel the constraint. Friction takes back slip at the end of the step: pressed nodes balance its
// force with the change of their inertia and of the springs between them and around them.
#pragma once

#include "lib/springs/integrator.h"
#include "lib/springs/spring_matrix.h"

namespace supple {

class ImplicitEuler final : public SpringIntegrator {
 public:
  struct Params {
    int newton_steps = 2;           // at most; 1: linearised
    int newton_steps_bounded = 20;  // the same where there are shapes or an awake barrier
    /// Newton ends below this part of the largest force (inertia included) at the step's start, or
    /// below `tolerance_mn`.
    double relative_tolerance = 1e-3;
    double tolerance_mn = 0;
  };
  /// Throws InputError as validate(system) and for parameters out of range, Cancelled.
  ImplicitEuler(SpringSystem& system, const Params& params, const Progress* progress = nullptr);
  explicit ImplicitEuler(SpringSystem& system, const Progress* progress = nullptr)
      : ImplicitEuler(system, Params(), progress) {}

  std::size_t bytes() const { return m_matrix.bytes(); }

 private:
  SpringStepReport advance(double dt_s) override;
  /// Finds -grad Phi in mN, 0 at held nodes and without the pressure on shapes; returns its largest
  /// length with that pressure.
  double descent(double dt_s, SpringStepReport& report);
  double potential(double dt_s) const;
  double mass_factor(double dt_s) const;
  void stay_on_shapes();
  void rub(double dt_s);

  Params m_params;
  SpringMatrix m_matrix;
  std::vector<Vec3d> m_start, m_start_velocity, m_force, m_step, m_before;
  std::vector<PressedNode> m_pressed;  // at the present positions
};

}  // namespace supple
