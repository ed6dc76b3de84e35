// Sheets at finite strain: membranes of St. Venant and Kirchhoff, which turn freely,
//
//   W(u) = sum over triangles of h A (lambda/2 (tr E)^2 + mu E:E),  E = (F^T F - P) / 2,
//
// with F and the part P in the plane as shell_triangles.h has them, of which the tangent at rest is
// the linear stiffness. Bending stays linear: as turns of edges are small angles, it resists turns
// of a curved sheet a little.
#pragma once

#include <array>
#include <vector>

#include "lib/fem/tet/block_csr.h"
#include "lib/fem/tet/shell_triangles.h"

namespace supple {

class FiniteSheets {
 public:
  /// `positions` of all nodes that are not turns, `node_count` with these.
  FiniteSheets(const ShellTriangles& sheets, const std::vector<Vec3d>& positions,
               std::size_t node_count);

  /// force += K(u); returns the energy in mN mm.
  double add_forces(const double* u_mm, double* force_mn) const;
  /// Adds the tangent at u.
  void add_tangent(const double* u_mm, BlockCsr& matrix) const;
  std::size_t bytes() const;

 private:
  struct Membrane {
    std::array<Vec3d, 3> gradients;
    double lambda = 0, mu = 0;  // times thickness and area, mN mm
  };
  struct Stretched {
    Matrix9 f{}, stress{};  // F, and lambda tr E P + 2 mu E
    double energy_uj = 0;
  };
  Stretched stretched(std::size_t membrane, const double* u_mm) const;
  std::vector<Stretched> all_stretched(const double* u_mm) const;

  std::vector<Membrane> m_membranes;
  NodeSets m_corners;
  SetsOfNodes m_of_node;
  ShellTriangles m_bent;  // the sheets that bend
  BlockCsr m_bending;
};

}  // namespace supple
