// What a residual r = f - K(u) says: how large it is, and by how much reactions changed since the
// last one. Where a node is held, r is minus the force of what holds it.
#pragma once

#include <algorithm>
#include <vector>

#include "lib/fem/fem_loads.h"

namespace supple {

struct ResidualSize {
  double max = 0, rms = 0;      // over nodes, relative to the largest nodal force
  double largest_mn = 0;        // the largest of a node
  double largest_force_mn = 0;  // of loads and reactions
  double reaction_change = 0;   // relative to the largest reaction, since the last one
  /// Length of the sum of all nodes' residuals relative to the sum of the lengths of loads and
  /// reactions, which is how far these are from balance. A smooth residual that is small at every
  /// node adds up.
  double balance = 0;

  bool is_within(double tolerance, double reaction_tolerance) const {
    return std::max({max, rms, balance}) <= tolerance && reaction_change <= reaction_tolerance;
  }
};

class ResidualMeter {
 public:
  /// `loads` must outlive this; its forces are those that act now.
  explicit ResidualMeter(const NodalLoads& loads);

  ResidualSize operator()(const std::vector<double>& r);

 private:
  const NodalLoads* m_loads;
  double m_largest_load_mn = 0, m_load_lengths_mn = 0;
  std::vector<Vec3d> m_reactions;
};

}  // namespace supple
