// A solution by finite elements, and the measures of its report (fem_report.h).
#pragma once

#include <vector>

#include "lib/fem/elastic_solid.h"
#include "lib/fem/element_state.h"
#include "lib/fem/fem_report.h"
#include "lib/fem/residual.h"

namespace supple {

struct FemSolution {
  /// Displacement in mm, LPS, three per node of the mesh.
  std::vector<double> u_mm;
  std::vector<FemReaction> reactions;  // as FemLoads::held
  std::vector<double> swelling_kpa;    // per element; empty where none swells
  FemReport report;
  double ritz_value = 1;  // the smallest that iterations with this matrix have seen; 1: none was
  double reaction_change_mn = 0;  // in the last iteration
};

/// The reactions on what each of loads.nodes_of holds, from r = f - K(u) (in motion less damping
/// and inertia) at nodes that lie where they rest or, at finite strain, displaced by u.
std::vector<FemReaction> reactions_of(const ElasticSolid& solid, const NodalLoads& loads,
                                      const std::vector<double>& r,
                                      const std::vector<double>* u_mm = nullptr);

/// The force alone in N, LPS, on what the `held`-th of loads.nodes_of holds.
Vec3d pull_n(const NodalLoads& loads, std::size_t held, const std::vector<double>& r);

/// Writes how large a residual is, and how far elements moved.
void note(const ResidualSize& size, FemReport& report);
void note(const LargestMotion& largest, FemReport& report);
MotionLimits limits_of(const FemParams& params);

/// Writes reactions, balance and energy from r = f - K(u), which is minus the force of what holds a
/// node. Sums of less than `least_force_mn` are rounding.
void balance(const NodalLoads& loads, const std::vector<double>& u, const std::vector<double>& r,
             double least_force_mn, FemReport& report);

}  // namespace supple
