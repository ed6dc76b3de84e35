// Size of a residual r = f - K(u), and the change of reactions since the last one. Where a node is
// held, r is minus the force of what holds it.
//
// A body that follows its handle as a whole ends without forces but for rounding, to which no
// residual is small. Forces therefore count at least kLeastForce of the largest that there has
// been, such as that of the handle before anything else moved, and a residual of kRoundingForce of
// it is as small as double precision makes it.
//
// Forces between elements that are held as a whole count nowhere: bone beside a lip that is led
// away would be pulled out of shape with thousands of times the force of all that is solved for.
#pragma once

#include <algorithm>
#include <vector>

#include "lib/fem/nodal_loads.h"

namespace supple {

constexpr double kLeastForce = 1e-9, kRoundingForce = 2e-15;

struct ResidualSize {
  double max = 0, rms = 0;  // over nodes, relative to the largest nodal force
  double largest_mn = 0;    // the largest of a node
  /// Largest load or reaction but for forces within what is held, at least kLeastForce of seen_mn.
  double largest_force_mn = 0;
  double seen_mn = 0;          // the largest force of a node that there has been, held or free
  double reaction_change = 0;  // relative to the largest reaction, since the last one
  double reaction_change_mn = 0;
  /// Length of the sum of all nodes' residuals relative to the sum of the lengths of loads and
  /// reactions, which is how far these are from balance. A smooth residual that is small at every
  /// node adds up.
  double balance = 0;

  /// True if it is as small as double precision makes it.
  bool is_rounding() const { return largest_mn <= kRoundingForce * seen_mn; }
  bool is_within(double tolerance, double reaction_tolerance) const {
    if (is_rounding()) return true;
    return std::max({max, rms, balance}) <= tolerance && reaction_change <= reaction_tolerance;
  }
};

/// Part of the decades to its limit, 0 to 1, that a measure has done which falls from 1.
double decades_done(double value, double limit);

/// Part of the way to these limits that the residual has come, 0 to 1: the decades that are done,
/// of the measure that has most of them left.
double part_of_way(const ResidualSize& size, double tolerance, double reaction_tolerance);

/// r = f.
void set_to_forces(const NodalLoads& loads, std::vector<double>& r);

class ResidualMeter {
 public:
  /// `loads` must outlive this; its forces are those that act now.
  explicit ResidualMeter(const NodalLoads& loads);

  ResidualSize operator()(const std::vector<double>& r);
  /// A force of a node that another meter has seen on the way here.
  void have_seen(double force_mn) { m_seen_mn = std::max(m_seen_mn, force_mn); }

 private:
  const NodalLoads* m_loads;
  double m_largest_load_mn = 0, m_load_lengths_mn = 0;
  double m_seen_mn = 0;
  std::vector<Vec3d> m_reactions;
};

}  // namespace supple
