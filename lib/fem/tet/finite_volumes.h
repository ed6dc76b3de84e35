// Tetrahedra at finite strain: the compressible neo-Hookean law that voxels have
// (voxel/finite_strain.h), with pressures at nodes where the elements have these.
//
//   W(u) = sum over elements of V (mu/2 (J^(-2/3) tr F^T F - 3) + k/2 (J - 1)^2 - p (J - 1))
//        + sum over nodes of V_p lambda/2 (J_p - 1)^2
//   F = 1 + du/dx,  J = det F,  J_p = what the tetrahedra around a node have as volume by what
//                                     they had at rest (Bonet & Burton 1998)
//
// k is the bulk modulus, less lambda where nodes have that: a body that swells evenly has the same
// energy by all elements. p is a swelling. At rest the tangent is the linear stiffness. Values of
// an element with ten nodes are means over its four points. Valid while J > 0 there.
#pragma once

#include <array>
#include <vector>

#include "lib/fem/newton.h"
#include "lib/fem/tet/tet_volumes.h"

namespace supple {

class FiniteVolumes {
 public:
  /// All but the swellings, per element or empty, must outlive this.
  FiniteVolumes(const TetVolumes& volumes, const std::vector<TetModuli>& of_material,
                std::vector<double> swelling_kpa);

  /// force += K(u), as NonlinearSystem has it.
  StrainEnergy add_forces(const double* u_mm, double* force_mn, double part) const;
  /// Adds the tangent at u.
  void add_tangent(const double* u_mm, double part, BlockCsr& matrix) const;
  /// States with the whole of the swellings.
  std::vector<ElementState> states(const std::vector<double>& u_mm) const;
  std::size_t bytes() const;

 private:
  /// A point of integration, displaced: its stress is P = shear F + mean cof F.
  struct Point {
    Matrix9 f, cofactor;
    double volume_change = 0;      // J - 1
    double shear = 0, trace = 0;   // mu J^(-2/3), and tr F^T F
    double pressure_of_shear = 0;  // shear trace / (3 J)
    double mean = 0;
    double density_kpa = 0;  // of energy, without swellings and the nodes' part
  };
  struct Displaced {
    std::vector<Point> points;    // per element
    std::vector<double> dilated;  // J_p - 1
  };
  const TetModuli& moduli(std::size_t element) const;
  double own_bulk(std::size_t element) const;
  double swelling(std::size_t element, double part) const;
  void displace(std::size_t element, const double* u_mm, Point* points) const;
  void find_dilated(Displaced& out) const;
  double mean_over_nodes(std::size_t element, const std::vector<double>& of_patch) const;
  Displaced displaced(const double* u_mm, double part) const;
  std::vector<Vec3d> patch_gradients(const Displaced& at) const;
  void add_row(const Point& point, double volume_mm3, const std::array<Vec3d, 10>& gradients,
               double own_bulk, std::size_t row, std::size_t count, Matrix9* blocks) const;

  const TetVolumes* m_volumes;
  const std::vector<TetModuli>* m_of_material;
  std::vector<double> m_swelling;
  SetsOfNodes m_of_node;        // elements around each node
  SetsOfNodes m_of_patch;       // elements in each patch
  std::vector<double> m_nodal;  // lambda of each patch
};

}  // namespace supple
