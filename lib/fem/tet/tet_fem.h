// Finite elements on meshes of tetrahedra: isotropic linear elasticity of a body, with thin sheets
// on its faces (docs/models/tets.md; thesis, chapter 6.2 and appendix B).
//
//   find u with  K u = f,  u prescribed where something is held
//
// Elements of volume are in tet_volumes.h, those of sheets in shell_triangles.h. Forces are in mN
// inside (kPa mm^2) and in N in reports. Equations are solved by conjugate gradients with
// incomplete Cholesky factors, or by exact factors for many loads; at finite strain by Newton's
// method (finite_volumes.h, finite_sheets.h). Results do not depend on the number of threads.
//
//   const ElasticSheet dura{"skull", SheetKind::both, 2500, 0.48, 0.6};
//   TetModel brain(mesh, TetElement::nodal_pressure, {dura});
//   TetLoads loads;
//   loads.held.push_back({brain.nodes_of_faces("held")});
//   loads.swelling_kpa.assign(mesh.tets.size(), 20 * 0.1333224);
//   TetSolution swollen = brain.solve(loads);
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lib/fem/elastic_solid.h"
#include "lib/fem/fem_solution.h"
#include "lib/fem/tet/shell_triangles.h"
#include "lib/fem/tet/tet_loads.h"
#include "lib/fem/tet/tet_volumes.h"

namespace supple {

struct TetParams {
  TetEquations equations = TetEquations::gradients;  // at finite strain these alone
  StrainTheory strain = StrainTheory::linear;
  double tolerance = 1e-8;           // as FemParams
  double reaction_tolerance = 1e-6;  // as FemParams; of conjugate gradients
  int max_iterations = 5000;         // of each linear system
  LooseIslands loose = LooseIslands::refuse;
  MotionLimits limits;  // of linear theory; larger motions are flagged

  /// Throws InputError.
  void validate() const;
};

struct TetSolution {
  /// Displacements in mm, LPS, three per node of the model; then the turns of edges in rad.
  std::vector<double> u_mm;
  std::vector<FemReaction> reactions;  // as TetLoads::held
  FemReport report;
  double least_det_f = 1;  // below 0: linear theory has turned an element inside out
  StrainTheory strain = StrainTheory::linear;
};

/// A mesh with its materials and sheets, ready for any number of solves; keeps a copy of what it
/// needs of the mesh.
class TetModel final : public ElasticSolid {
 public:
  /// Throws InputError: a mesh or a value that cannot be used. Without tetrahedra, a mesh may have
  /// sheets alone.
  TetModel(const SolidMesh& mesh, TetElement element, std::vector<ElasticSheet> sheets = {});
  ~TetModel() override;

  const TetVolumes& volumes() const { return m_volumes; }
  const ShellTriangles& shells() const { return m_shells; }
  const std::vector<TetModuli>& moduli() const { return m_moduli; }
  const BlockCsr& stiffness() const { return m_stiffness; }

  /// Number of nodes with positions: those of the mesh, and middles of edges. Turns follow.
  std::size_t place_count() const { return m_volumes.positions().size(); }
  /// Nodes of a set of faces, ascending, with middles of edges. Throws InputError: no such set.
  std::vector<NodeIndex> nodes_of_faces(const std::string& name) const;
  double area_of_faces(const std::string& name) const;
  /// The triangles of sets of faces between neighbouring nodes: with ten nodes, four of each face.
  std::vector<std::array<NodeIndex, 3>> parts_of_faces(const std::vector<std::string>& names) const;
  double area_of(const std::array<NodeIndex, 3>& triangle) const;

  /// Loads at nodes; at finite strain swellings, whose forces turn with their elements, are beside
  /// the forces. Throws InputError.
  NodalLoads nodal_loads(const TetLoads& loads, StrainTheory strain = StrainTheory::linear) const;
  /// Pressures on faces push as faces lie at rest. Throws InputError, NotConverged, Cancelled.
  TetSolution solve(const TetLoads& loads, const TetParams& params = {},
                    Progress* progress = nullptr) const;

  std::vector<ElementState> states(const TetSolution& solution, const TetLoads& loads) const;
  /// Writes how far elements turn and strain, and the least det F.
  void note_motion(TetSolution& solution, const TetLoads& loads, const MotionLimits& limits) const;

  std::int64_t element_count() const override { return std::int64_t(m_volumes.element_count()); }
  std::int64_t node_count() const override { return std::int64_t(m_stiffness.node_count()); }
  /// Positions at rest; a node of turns has the middle of its first edge.
  std::vector<Vec3d> node_positions() const override { return m_positions; }
  std::vector<Vec3d> node_positions(const std::vector<NodeIndex>& nodes) const override;
  std::vector<std::array<Vec3d, 3>> turn_axes() const override;
  NodePieces node_pieces() const override;
  LooseCount hold_loose(bool holds, HeldBits& held) const override;
  const Operator& matrix() const override { return m_stiffness; }
  /// Classes of the weights are the materials of the mesh, and after them the sheets.
  std::unique_ptr<Operator> weighted(const ElementWeights& weights) const override;
  std::unique_ptr<LinearSystem> system(const ElementWeights* weights, const HeldBits& held,
                                       Progress* progress) const override;
  std::size_t bytes() const override;

 private:
  const FaceSet& faces_named(const std::string& name) const;
  void require_place(NodeIndex node, const char* of) const;
  void hold(const TetHeld& held, NodalLoads& out) const;
  void add_pressure(const FacePressure& pressure, std::vector<double>& force_mn) const;
  void add_swelling(const TetLoads& loads, StrainTheory strain, NodalLoads& out) const;
  void add_gravity(const TetLoads& loads, std::vector<double>& force_mn) const;
  TetSolution solve_finite(const TetLoads& loads, const TetParams& params,
                           Progress* progress) const;
  BlockCsr weighted_matrix(const ElementWeights& weights) const;

  std::vector<FaceSet> m_faces;
  TetVolumes m_volumes;
  std::vector<TetModuli> m_moduli;  // per material
  std::vector<ElasticSheet> m_sheets;
  ShellTriangles m_shells;
  std::vector<Vec3d> m_positions;
  BlockCsr m_stiffness;
};

/// The equations of one model with the same components held, made ready once for many loads.
class TetSolver {
 public:
  /// `model` must outlive this. Throws as TetModel::solve(), InputError for finite strain.
  TetSolver(const TetModel& model, const TetLoads& held, const TetParams& params,
            Progress* progress = nullptr);
  ~TetSolver();

  /// Throws InputError where other components are held, NotConverged, Cancelled.
  TetSolution solve(const TetLoads& loads, Progress* progress = nullptr) const;
  std::size_t bytes() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> m_parts;
};

}  // namespace supple
