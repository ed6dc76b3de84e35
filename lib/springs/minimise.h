// Static relaxation: a spring system to a minimum of its energy (springs and gravity), as after ECM
// in the thesis (section 4.2.3, second method). Newton's method with the positive semidefinite
// matrix of implicit steps, damped by a multiple of the masses that falls while steps succeed (an
// implicit Euler step that forgets its velocity and grows), with a line search: every step lowers
// the energy.
#pragma once

#include "lib/springs/spring_system.h"
#include "volumes/base/progress.h"

namespace supple {

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

/// Moves the free nodes; held ones go to their targets first, all velocities become 0. Ends without
/// convergence after max_steps, or where rounding leaves no descent. Contact and damping play no
/// part. When `progress` cancels, between two steps, it returns what it has: a valid state of less
/// energy, but not necessarily one whose ChainMail limits hold. Throws InputError as validate.
MinimiseReport minimise(SpringSystem& system, const MinimiseParams& params = {},
                        Progress* progress = nullptr);

}  // namespace supple
