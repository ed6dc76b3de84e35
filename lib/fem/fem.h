// Voxel finite elements: isotropic elasticity of a body, linear or at finite strain, one trilinear
// hexahedron per element voxel (design.md section 6; docs/models/fem.md).
//
//   find u with  K u = f,  u prescribed where something is held,
//   K = sum over elements of  integral B^T D B,  D from Young's modulus E and Poisson's ratio nu
//
// At finite strain K(u) = f, with the neo-Hookean energy of finite_strain.h, whose K(u) is K u for
// small u; solved by Newton's method in steps of the load (newton.h).
//
// Nodes lie at voxel corners, in LPS mm. A corner around which the elements fall into several
// pieces (pieces are joined over faces whose link is not cut) has one node per piece, so that cuts
// open and voxels that touch by an edge or corner alone are not joined. Forces are in mN inside
// (kPa mm^2) and in N in reports.
//
// Solver: conjugate gradients in double precision, preconditioned by one geometric multigrid cycle
// in single precision (multigrid.h). Results do not depend on the number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"
#include "lib/fem/element_matrix.h"
#include "lib/fem/fem_loads.h"
#include "lib/fem/hex_mesh.h"
#include "lib/fem/newton_report.h"
#include "volumes/base/progress.h"

namespace supple {

class HexOperator;
struct MeshLevels;

constexpr int kMostDoublings = 3;

/// Elastic constants per material class (Body::classes).
struct ElasticTable {
  std::array<double, kLastClass + 1> young_kpa, poisson;

  static ElasticTable uniform(double young_kpa, double poisson);
  /// Throws InputError: 0 < E < infinity, -1 < nu <= kLargestPoisson expected.
  void validate() const;
};

/// What becomes of islands: pieces of the body whose rigid motions nothing prevents.
enum class LooseIslands {
  hold,   // their nodes stay where they are, and what acts on them is carried by what holds them
  refuse  // an error
};

/// Who solves the linear equations: the own multigrid, CalculiX's direct solver (SPOOLES), its
/// conjugate gradients with incomplete Cholesky factors, or DOLFINx with algebraic multigrid.
enum class EquationSolver { multigrid, calculix, calculix_iterative, dolfinx };

/// What a solution is for: numbers, to the rounding of states; or a picture, whose errors lie far
/// below a pixel. A picture goes on from an earlier equilibrium of the body where there is one.
enum class FemAccuracy { exact, picture };
constexpr double kPictureTolerance = 0.1;  // of residual and reactions

struct FemParams {
  /// Chosen by set_accuracy(), which both tolerances follow.
  FemAccuracy accuracy = FemAccuracy::exact;
  StrainTheory strain = StrainTheory::linear;
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

/// With which the body pulls at what holds it.
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

/// Of what each of loads.nodes_of holds, from r = f - K(u) (in motion less damping and inertia) at
/// nodes that lie where they rest or, at finite strain, displaced by u.
std::vector<FemReaction> reactions_of(const HexMesh& mesh, const NodalLoads& loads,
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

/// A body with elastic constants, ready for any number of solves. Keeps nothing of the body but its
/// shape, cuts and classes.
class FemModel {
 public:
  /// Throws InputError: a value of `elastic` out of range, a body without elements.
  FemModel(const Body& body, const ElasticTable& elastic, Dilatation dilatation = Dilatation::mean,
           Progress* progress = nullptr);
  ~FemModel();

  const HexMesh& mesh() const;
  const VoxelMaterial& material() const;

  /// Throws InputError (a value out of range, loose islands that are refused, a solver that is not
  /// installed), NotConverged, Error of another solver, Cancelled.
  /// `start`: of the mesh's nodes, to begin from; null: rest. Finite strain begins at rest.
  FemSolution solve(const FemLoads& loads, const FemParams& params = {},
                    Progress* progress = nullptr, const NodeStart* start = nullptr) const;

  /// K u in mN, three per node: the linear operator as it is, for checks and other solvers.
  void apply(const std::vector<double>& u_mm, std::vector<double>& force_mn) const;

  const HexOperator& stiffness() const;
  /// The meshes of the multigrid cycle.
  const MeshLevels& levels() const;
  /// Of these and of what they are made of.
  std::size_t bytes() const;

 private:
  struct Parts;
  void solve_linear(NodalLoads& loads, const FemParams& params, Progress* progress,
                    FemSolution& out) const;
  void solve_by_peer(NodalLoads& loads, const FemParams& params, Progress* progress,
                     FemSolution& out) const;
  void solve_coarse(NodalLoads& loads, const FemParams& params, Progress* progress,
                    FemSolution& out) const;
  template <class Solver>
  void run_linear(Solver& solver, const NodalLoads& loads, const FemParams& params,
                  Progress* progress, FemSolution& out) const;
  void solve_finite(NodalLoads& loads, const FemParams& params, Progress* progress,
                    FemSolution& out) const;
  std::unique_ptr<Parts> m_parts;
};

}  // namespace supple
