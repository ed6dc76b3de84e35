// Parameters of a solution by finite elements, and the report that it gives of itself.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lib/fem/elastic_law.h"
#include "lib/fem/elastic_solid.h"
#include "lib/fem/element_state.h"
#include "lib/fem/newton_report.h"
#include "lib/fem/nodal_loads.h"
#include "lib/fem/residual.h"
#include "volumes/base/error.h"

namespace supple {

constexpr int kMostDoublings = 3;

/// Solver of the linear equations: the own multigrid, CalculiX's direct solver (SPOOLES), its
/// conjugate gradients with incomplete Cholesky factors, or DOLFINx with algebraic multigrid.
enum class EquationSolver { multigrid, calculix, calculix_iterative, dolfinx };

/// Purpose of a solution: numbers, to the rounding of states; or a picture, whose errors lie far
/// below a pixel. A picture goes on from an earlier equilibrium of the body where there is one.
enum class FemAccuracy { exact, picture };
constexpr double kPictureTolerance = 0.1;  // of residual and reactions

struct FemParams {
  /// Chosen by set_accuracy(), which both tolerances follow.
  FemAccuracy accuracy = FemAccuracy::exact;
  StrainTheory strain = StrainTheory::linear;
  ElementChoice elements;  // of models that are made for these parameters
  /// Ends when the residual, largest and rms over nodes, is at most this part of the largest nodal
  /// force (of loads, reactions included) and the reactions changed by at most
  /// `reaction_tolerance`, relative, over the last iteration.
  double tolerance = 1e-6;
  double reaction_tolerance = 1e-5;
  int max_iterations = 400;  // of each linear system
  /// Elements of 2^doublings voxels in each direction (coarse_elements.h); in linear theory.
  int doublings = 0;
  /// Others than the own one know linear theory without `doublings`; what they leave on nodes
  /// beyond `tolerance` is a warning.
  EquationSolver solver = EquationSolver::multigrid;
  LooseIslands loose = LooseIslands::hold;
  /// Bounds of linear theory; larger ones are flagged.
  double max_rotation_deg = 5;
  double max_strain = 0.05;

  void set_accuracy(FemAccuracy chosen);
  /// Throws InputError.
  void validate() const;
};

/// Resultant force and moment with which the body pulls at one held set.
struct FemReaction {
  Vec3d force_n{0, 0, 0};     // LPS
  Vec3d moment_nmm{0, 0, 0};  // LPS, about `centre_mm`
  Vec3d centre_mm{0, 0, 0};  // mean position of the nodes: at rest, at finite strain where they are
  std::int64_t nodes = 0;
};

struct FemReport {
  std::int64_t elements = 0, nodes = 0, unknowns = 0;  // of elements of several voxels, too
  int levels = 0;
  int iterations = 0;
  double residual_max = 0, residual_rms = 0;  // relative to the largest nodal force
  double largest_force_n = 0;
  /// |sum of loads and reactions| relative to the sum of their lengths.
  double force_balance = 0;
  /// |u.K(u) - u.(f + r)| relative to u.K(u); r are the reactions.
  double energy_identity = 0;
  double energy_mj = 0;        // u.Ku / 2, or W(u)
  double reaction_change = 0;  // relative, over the last iteration
  std::int64_t loose_islands = 0, loose_elements = 0, islands = 0;
  double largest_rotation_deg = 0, largest_strain = 0;
  Vec3i turned{0, 0, 0}, strained{0, 0, 0};  // where, in voxels of the mesh
  std::int64_t beyond_elements = 0;          // that turn or strain by more than the bounds
  bool beyond_linear = false;                // never at finite strain
  std::optional<NewtonReport> newton;        // at finite strain
  std::size_t bytes = 0;                     // at the most, of the solver and its mesh
  double setup_ms = 0, solve_ms = 0;
};

struct FemSolution {
  /// Displacement in mm, LPS, three per node of the mesh.
  std::vector<double> u_mm;
  std::vector<FemReaction> reactions;  // as FemLoads::held
  FemReport report;
};

/// The reactions on what each of loads.nodes_of holds, from r = f - K(u) (in motion less damping
/// and inertia) at nodes that lie where they rest or, at finite strain, displaced by u.
std::vector<FemReaction> reactions_of(const ElasticSolid& solid, const NodalLoads& loads,
                                      const std::vector<double>& r,
                                      const std::vector<double>* u_mm = nullptr);

/// The solver did not reach its tolerances; the message carries the numbers.
class NotConverged : public Error {
 public:
  explicit NotConverged(const FemReport& report);
  const FemReport& report() const { return m_report; }

 private:
  FemReport m_report;
};

/// Writes how large a residual is, and how far elements moved.
void note(const ResidualSize& size, FemReport& report);
void note(const LargestMotion& largest, FemReport& report);
MotionLimits limits_of(const FemParams& params);

/// Writes reactions, balance and energy from r = f - K(u), which is minus the force of what holds a
/// node. Sums of less than `least_force_mn` are rounding.
void balance(const NodalLoads& loads, const std::vector<double>& u, const std::vector<double>& r,
             double least_force_mn, FemReport& report);

}  // namespace supple
