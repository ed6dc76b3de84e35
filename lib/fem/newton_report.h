// Report of Newton's method (newton.h) on its steps.
#pragma once

#include <vector>

namespace supple {

struct NewtonReport {
  int load_steps = 0, rejected_steps = 0;
  int newton_iterations = 0, shortened_steps = 0;  // the latter by the line search
  int cg_iterations = 0;
  double load_part = 0;  // for which equilibrium was found
  double smallest_j = 1;
  double energy_uj = 0;
  /// Largest residual of a node after each iteration of the last load step, mN.
  std::vector<double> residuals_mn;
};

}  // namespace supple
