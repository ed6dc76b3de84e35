// Equilibrium at finite strain by Newton's method in steps of the load (finite_strain.h has the
// equations).
//
//   step:     T(u) d = f(t) - K(u), d as prescribed at what is held; u + d starts the corrections
//   correct:  T(u) d = f(t) - K(u), d = 0 at what is held; u + s d by a line search for the energy
//
// Each system is solved by conjugate gradients as far as the residual is small (inexact Newton,
// Dembo, Eisenstat and Steihaug 1982), with the multigrid cycle of the stiffness at rest between
// turned vectors as preconditioner (NodeTurns). A step that turns an element's inside out, or whose
// corrections do not converge, is repeated with half the load; after easy ones the next is twice as
// long.
#pragma once

#include <vector>

#include "lib/fem/conjugate_gradients.h"
#include "lib/fem/fem_loads.h"
#include "lib/fem/finite_strain.h"
#include "lib/fem/multigrid.h"
#include "lib/fem/newton_report.h"

namespace supple {

struct NewtonLimits {
  double tolerance = 1e-6, reaction_tolerance = 1e-5;  // as CgLimits
  int max_cg_iterations = 400;                         // of one linear system
  int max_load_steps = 200;
};

class Newton {
 public:
  /// All must outlive this. Takes the prescribed displacements and forces of `loads`.
  Newton(const HexMesh& voxels, const FiniteStrain& strain, const VoxelMaterial& material,
         Multigrid& multigrid, NodalLoads& loads, const NewtonLimits& limits);

  /// False where a step would be too short, with the last equilibrium in u(). Throws Cancelled.
  bool run(Progress* progress);

  const NewtonReport& report() const { return m_report; }
  const ResidualSize& size() const { return m_size; }
  const std::vector<double>& u() const { return m_u; }
  /// f - K(u).
  const std::vector<double>& residual() const { return m_r; }
  std::vector<double> take_u() { return std::move(m_u); }
  std::size_t bytes() const { return m_bytes; }

 private:
  bool evaluate();
  bool predict(double& part, Progress* progress);
  bool correct(bool is_last, Progress* progress);
  void tell(double tolerance, Progress* progress);
  bool search_along(const std::vector<double>& d);
  std::vector<double> solve_tangent(const CgLimits& limits, Progress* progress, bool& found);

  const HexMesh* m_mesh;
  const FiniteStrain* m_strain;
  const VoxelMaterial* m_material;
  Multigrid* m_multigrid;
  NodalLoads* m_loads;
  NewtonLimits m_limits;
  LoadPath m_path;
  NewtonReport m_report;
  ResidualSize m_size;
  StrainEnergy m_energy;
  std::vector<double> m_whole_mn;  // the loads' forces, or empty
  double m_part = 0;               // of the loads that acts now
  double m_told_part = 0;
  std::vector<double> m_u, m_r;
  NodalLoads m_system_loads;  // of the linear systems
  ResidualMeter m_meter;
  std::size_t m_bytes = 0;
};

}  // namespace supple
