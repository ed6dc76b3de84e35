// Elasticity at finite strain on the hexahedra of the voxels: compressible neo-Hookean, with the
// mean dilatation of each element (Simo, Taylor and Pister, Comput. Methods Appl. Mech. Eng. 51,
// 177-208, 1985), so that elements do not lock, as in the linear operator.
//
//   W(u) = sum over elements of  integral mu/2 (J^(-2/3) tr F^T F - 3)  +  V kappa/2 (theta - 1)^2
//   F = 1 + du/dx,  J = det F,  theta = the element's volume over that at rest, V
//   K(u) = dW/du,  its tangent = d^2W/du^2, symmetric; at u = 0 that is the linear stiffness
//
// Dilatation::pointwise has J for theta: CalculiX' NEO HOOKE with C10 = mu/2 and D1 = 2/kappa on
// C3D8. Integrals are by 2 x 2 x 2 Gauss points; the volume is exact. A swelling p in an element
// adds -p V (theta - 1). Valid while J > 0 at all Gauss points.
//
// Nothing is stored per element: both products compute F anew. Same bits on any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/fem/newton.h"
#include "lib/fem/voxel/element_groups.h"
#include "lib/fem/voxel/voxel_material.h"

namespace supple {

struct LaneModuli;

class FiniteStrain {
 public:
  /// Both must outlive this. `swelling_kpa` is per element, or empty.
  FiniteStrain(const HexMesh& mesh, const VoxelMaterial& material,
               const std::vector<double>& swelling_kpa = {});

  /// force += K(u) in mN, u in mm, three values per node, with `part` of the swellings. `force`
  /// means nothing where smallest_j is not above 0.
  StrainEnergy add_forces(const double* u, double* force, double part = 1) const;

  /// y += T x or y -= T x with the tangent T at u.
  template <class X>
  void add_tangent(const double* u, const X* x, double* y, double part = 1) const;
  template <class X>
  void subtract_tangent(const double* u, const X* x, double* y, double part = 1) const;

  std::size_t bytes() const;

 private:
  template <class X>
  void accumulate_tangent(const double* u, const X* x, double* y, double part, double sign) const;
  LaneModuli moduli_of(std::size_t group, double part) const;

  const HexMesh* m_mesh;
  const VoxelMaterial* m_material;
  GaussGeometry m_geometry;
  ElementGroups m_groups;
  std::vector<double> m_swelling;  // per lane, or empty
};

/// Values of one element: theta - 1, and its energy per volume at rest without that of a swelling.
struct ElementEnergy {
  double volume_change, density_kpa;
};
ElementEnergy element_energy(const HexMesh& mesh, const VoxelMaterial& material,
                             const std::vector<double>& u_mm, std::int32_t element);

/// Turns of nodes for the preconditioner: the tangent of a body that has turned as a whole is its
/// stiffness at rest between turned vectors, and where the body has turned differently from place
/// to place it is nearly so.
class NodeTurns {
 public:
  /// Finds turns by the mean gradient of the elements around each node. Nodes of which a component
  /// is held do not turn.
  NodeTurns(const HexMesh& mesh, const VoxelMaterial& material, const HeldBits& held,
            const std::vector<double>& u_mm);

  /// x = R x or x = R^T x, three values per node.
  void turn(float* x) const;
  void turn_back(float* x) const;
  std::size_t bytes() const { return m_turns.capacity() * sizeof(m_turns[0]); }

 private:
  std::vector<std::array<float, 9>> m_turns;  // rows
};

}  // namespace supple
