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
// open and voxels that touch by an edge or corner alone are not joined; unless Touching::joined
// asks for it. Forces are in mN inside (kPa mm^2) and in N in reports.
//
// Solver: conjugate gradients in double precision, preconditioned by one geometric multigrid cycle
// in single precision (multigrid.h). Results do not depend on the number of threads.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lib/body/body.h"
#include "lib/fem/elastic_solid.h"
#include "lib/fem/fem_solution.h"
#include "lib/fem/response/response_set.h"
#include "lib/fem/voxel/fem_loads.h"
#include "lib/fem/voxel/hex_mesh.h"
#include "lib/fem/voxel/voxel_material.h"
#include "volumes/base/progress.h"

namespace supple {

class HexOperator;
struct MeshLevels;
struct PeerProblem;

/// A solution of nodal loads.
struct NodalSolution {
  std::vector<double> u_mm, residual_mn;  // three per node
  double residual_max = 0;                // of ResidualSize
  SolvedTo to;
  double ritz_value = 1;  // FemSolution::ritz_value
  int iterations = 0;
  std::size_t bytes = 0;  // at the most, with the solver, its mesh and the solutions before it
};

/// A body with elastic constants, ready for any number of solves. Keeps nothing of the body but its
/// shape, cuts and classes.
class FemModel final : public ElasticSolid {
 public:
  /// Throws InputError: a value of `elastic` out of range, a body without elements.
  FemModel(const Body& body, const ElasticTable& elastic, const ElementChoice& choice = {},
           Progress* progress = nullptr);
  ~FemModel() override;

  /// Parts pieces of elements that share nodes with others and can turn there without strain, with
  /// these components of nodes held: so they are loose islands. True where there are such; the mesh
  /// is another then. `body` is that of the model. Throws Cancelled.
  bool part_hinges(const Body& body, const HeldBits& held, Progress* progress = nullptr);
  /// Joins the pieces again that part_hinges() has parted.
  void join_hinges(const Body& body, Progress* progress = nullptr);

  const HexMesh& mesh() const;
  const VoxelMaterial& material() const;

  /// Throws InputError (a value out of range, loose islands that are refused, a solver that is not
  /// installed, hinges: see part_hinges()), NotConverged, Error of another solver, Cancelled.
  /// `start`: of the mesh's nodes, to begin from; null: rest. Finite strain begins at rest.
  FemSolution solve(const FemLoads& loads, const FemParams& params = {},
                    Progress* progress = nullptr, const NodeStart* start = nullptr) const;

  /// The same in linear theory, by a sum of the solutions in `known` where these make it; what is
  /// missing is solved for and joins them. Those of other held elements, loads or parameters are
  /// forgotten. A sum that leaves more than twice the tolerance is where iterations begin. Beside
  /// `error_mm` solutions whose errors would add up to more are solved further first. Throws
  /// likewise.
  FemSolution solve_by(ResponseSet& known, const FemLoads& loads, const FemParams& params,
                       Progress* progress = nullptr) const;

  /// The nodal values of loads, as solve() checks them; writes elements, nodes, unknowns and
  /// islands. Throws likewise.
  NodalLoads checked_loads(const FemLoads& loads, const FemParams& params, Progress* progress,
                           FemReport& report) const;
  /// Solves several loads with the same held components beside each other, in linear theory by the
  /// own solver; each has the bits of a solution alone. Iterations start from the free components
  /// of loads.u_mm. Throws NotConverged, Cancelled.
  std::vector<NodalSolution> solve_beside(std::vector<NodalLoads> loads, const FemParams& params,
                                          Progress* progress = nullptr) const;

  /// Puts such a solution, of loads with or without the forces of `base`, into a set that
  /// solve_by() goes on with for `base`; a direction of less than `rounding_mm` beside the others
  /// is left out.
  void keep(const NodalLoads& base, const NodalLoads& loads, NodalSolution solution,
            const FemParams& params, double rounding_mm, ResponseSet& known) const;

  /// K u in mN, three per node: the linear operator as it is, for checks and other solvers.
  void apply(const std::vector<double>& u_mm, std::vector<double>& force_mn) const;

  const HexOperator& stiffness() const;
  /// The meshes of the multigrid cycle.
  const MeshLevels& levels() const;
  /// Memory of the meshes and of what they are made of.
  std::size_t bytes() const override;

  std::int64_t element_count() const override { return mesh().element_count(); }
  std::int64_t node_count() const override { return mesh().node_count(); }
  std::vector<Vec3d> node_positions() const override;
  std::vector<Vec3d> node_positions(const std::vector<NodeIndex>& nodes) const override;
  NodePieces node_pieces() const override;
  LooseCount hold_loose(bool holds, HeldBits& held) const override;
  const Operator& matrix() const override;
  std::unique_ptr<Operator> weighted(const ElementWeights& weights) const override;
  std::unique_ptr<LinearSystem> system(const ElementWeights* weights, const HeldBits& held,
                                       Progress* progress) const override;

 private:
  struct Parts;
  std::vector<bool> hinged(const HeldBits& held) const;
  const std::vector<bool>& parted() const;
  void conclude(const NodalLoads& loads, const FemParams& params, const ResidualSize& size,
                const std::vector<double>& residual, std::vector<double> u, FemSolution& out) const;
  std::optional<FemSolution> sum_of(const ResponseSet& known, const ResponseParts& parts,
                                    NodalLoads& loads, const FemParams& params,
                                    const FemReport& report) const;
  int sharpen(ResponseSet& known, const ResponseParts& parts, const NodalLoads& loads,
              const FemParams& params, Progress* progress) const;
  void solve_linear(NodalLoads& loads, const FemParams& params, Progress* progress,
                    FemSolution& out) const;
  PeerProblem peer_problem() const;
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
