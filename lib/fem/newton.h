// Equilibrium at finite strain by Newton's method in steps of the load (voxel/finite_strain.h has
// the equations of voxels).
//
//   step:     T(u) d = f(t) - K(u), d as prescribed at what is held; u + d starts the corrections
//   correct:  T(u) d = f(t) - K(u), d = 0 at what is held; u + s d by a line search for the energy
//
// Swellings, whose forces turn and grow with their elements, are part of K and grow with t, too.
//
// Each system is solved by conjugate gradients as far as the residual is small (inexact Newton,
// Dembo, Eisenstat and Steihaug 1982), with the preconditioner that the
// elements give. A step that turns an element's inside out, or whose
// corrections do not converge, is repeated with half the load; after easy ones the next is twice as
// long.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "lib/fem/conjugate_gradients.h"
#include "lib/fem/elastic_solid.h"
#include "lib/fem/fem_report.h"
#include "lib/fem/nodal_loads.h"
#include "lib/fem/operator.h"

namespace supple {

struct StrainEnergy {
  double energy_uj = 0;                                         // mN mm
  double smallest_j = std::numeric_limits<double>::infinity();  // of all Gauss points
};

/// Elements at finite strain.
class NonlinearSystem {
 public:
  virtual ~NonlinearSystem() = default;
  /// force += K(u) in mN, u in mm, three values per node, elements that swell by `part` of their
  /// pressure. `force` means nothing where smallest_j is not above 0.
  virtual StrainEnergy add_forces(const double* u, double* force, double part) const = 0;
  /// The tangent at u, which must outlive it, with a preconditioner.
  virtual std::unique_ptr<LinearSystem> tangent_at(const std::vector<double>& u_mm,
                                                   double part) const = 0;
  /// The largest turn of an element by displacements that are small.
  virtual double largest_turn_deg(const std::vector<double>& u_mm) const = 0;
};

/// Counts swellings as forces of the loads at u, where r = f - K(u), and not as elasticity. Returns
/// the energy without them.
double take_swellings(const NonlinearSystem& system, const std::vector<double>& u,
                      const std::vector<double>& r, NodalLoads& loads);

struct NewtonLimits {
  double tolerance = 1e-6, reaction_tolerance = 1e-5;  // as CgLimits
  int max_cg_iterations = 400;                         // of one linear system
  int max_load_steps = 200;
};

class Newton {
 public:
  /// All must outlive this. Takes the prescribed displacements and forces of `loads`.
  Newton(const ElasticSolid& solid, const NonlinearSystem& system, NodalLoads& loads,
         const NewtonLimits& limits);

  /// Solves; false where steps get too short, with the last equilibrium in u(). Throws Cancelled.
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
  void find_load_from_here(double part);
  bool predict(double& part, Progress* progress);
  bool correct(bool is_last, Progress* progress);
  void tell(double tolerance, Progress* progress);
  bool search_along(const std::vector<double>& d);
  std::vector<double> solve_tangent(const CgLimits& limits, Progress* progress, bool& found);

  const NonlinearSystem* m_system;
  NewtonLimits m_limits;
  LoadPath m_path;
  NewtonReport m_report;
  ResidualSize m_size;
  StrainEnergy m_energy;
  std::vector<double> m_whole_mn;  // the loads' forces, or empty
  bool m_swells;                   // elements do, whose forces are part of K(u)
  double m_part = 0;               // of the loads that acts now
  double m_told_part = 0;
  std::vector<double> m_u, m_r;
  NodalLoads m_system_loads;  // of the linear systems
  ResidualMeter m_meter;
  std::size_t m_bytes = 0;
};

}  // namespace supple
