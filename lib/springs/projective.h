// Projective dynamics (Liu et al., Fast simulation of mass-spring systems, 2013; Bouaziz et al.,
// Projective dynamics, 2014): implicit Euler whose matrix does not depend on the configuration, so
// that it is factorised once. An iteration gives every spring the vector p of its rest length that
// is nearest, and solves
//   (M (1/h^2 + alpha/h) + sum (k + d/h) L) x = M (y/h^2 + ...) + sum k p + d/h p_d
// for all nodes; L is the Laplacian of one spring and p_d takes the motion along the spring out of
// its present motion. No iteration increases the incremental potential of implicit_euler.h,
// whatever k and h; the first ones do most, the last digits come slowly.
//
// Cost of an iteration: one pass over the springs and one back-solve of three right-hand sides.
#pragma once

#include <memory>

#include "lib/springs/integrator.h"

namespace supple {

class ProjectiveDynamics final : public SpringIntegrator {
 public:
  struct Params {
    int iterations = 15;
  };
  /// Throws InputError as validate(system), and for less than one iteration.
  ProjectiveDynamics(SpringSystem& system, const Params& params);
  explicit ProjectiveDynamics(SpringSystem& system) : ProjectiveDynamics(system, Params()) {}
  ~ProjectiveDynamics() override;

 private:
  struct Solver;

  /// Steps of another length, or another mass damping, factorise anew.
  SpringStepReport advance(double dt_s) override;
  void factorise(double dt_s);
  /// Finds m_goal, the springs' part of the right-hand side and of their forces at held nodes.
  void project_springs(double dt_s);

  Params m_params;
  double m_factorised_dt_s = 0, m_factorised_alpha = 0;
  std::vector<int> m_row;  // per node; -1: held
  std::unique_ptr<Solver> m_solver;
  std::vector<Vec3d> m_start, m_inertia, m_goal;  // m_goal: per spring, (k p + d/h p_d)
  int m_without_direction = 0;
};

}  // namespace supple
