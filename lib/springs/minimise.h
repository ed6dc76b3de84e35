// Static relaxation: a spring system to a minimum of its energy (springs and gravity), as after ECM
// in the thesis (section 4.2.3, second method). Newton's method with the positive semidefinite
// matrix of implicit steps, damped by a multiple of the masses that falls while steps succeed (an
// implicit Euler step that forgets its velocity and grows), with a line search: every step lowers
// the energy. In solids its equations are solved by conjugate gradients to a hundredth only
// (inexact Newton: R. Dembo, S. Eisenstat, T. Steihaug, SIAM J. Numer. Anal. 19, 1982).
#pragma once

#include <memory>
#include <vector>

#include "lib/springs/spring_system.h"
#include "volumes/base/progress.h"

namespace supple {

class SpringMatrix;

/// One minimisation, step by step. Contact and damping play no part.
class Minimiser {
 public:
  /// Held nodes go to their targets, all velocities become 0. The system's nodes, springs and which
  /// nodes are held must not change meanwhile. Throws InputError as validate(system), Cancelled.
  explicit Minimiser(SpringSystem& system, const Progress* progress = nullptr);
  ~Minimiser();

  /// Lowers the energy. False where rounding leaves no descent: further steps change nothing.
  /// Throws Cancelled, the system as it was before.
  bool step(const Progress* progress = nullptr);
  /// Largest force that is left on a free node.
  double residual_mn() const { return m_residual_mn; }

 private:
  bool descend();

  SpringSystem& m_system;
  std::vector<char> m_is_held;
  std::unique_ptr<SpringMatrix> m_matrix;
  double m_highest, m_least;  // mass factors, 1/s^2
  double m_mass_factor;
  double m_residual_mn;
  std::vector<Vec3d> m_step, m_before;
};

struct MinimiseParams {
  double tolerance_mn = 1e-3;  // largest force on a free node at the end
  int max_steps = 500;
};

struct MinimiseReport {
  int steps = 0;
  double residual_mn = 0;  // largest force that is left on a free node
  bool converged = false;  // residual_mn <= tolerance_mn
  SpringEnergy before, after;
};

/// Steps down to the tolerance, or as far as they lead. When `progress` cancels, between two steps,
/// it returns the present state: a valid one of less energy, but not necessarily one whose
/// ChainMail limits hold. Throws InputError as validate(system).
MinimiseReport minimise(SpringSystem& system, const MinimiseParams& params = {},
                        Progress* progress = nullptr);

}  // namespace supple
