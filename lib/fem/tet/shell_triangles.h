// Thin elastic sheets such as the Dura, as triangles between nodes of a mesh: V resists stretch in
// its plane, B bending out of it, BV both (thesis, appendix B). All three are written in space,
// without a frame of the triangle, and rigid motions cost nothing.
//
// V, a membrane in plane stress with linear displacements; g_a are gradients in the plane, P takes
// the part in the plane, F is the area, h the thickness:
//
//   K_ab = h F (lambda g_a g_b^T + mu g_b g_a^T + mu (g_a . g_b) P),
//   lambda = E nu / (1 - nu^2), mu = E / (2 (1 + nu))
//
// B, the triangle of Morley (1968) with a quadratic deflection w: unknowns are w at the corners and
// dw/dn in the middles of edges. As grad w is linear along an edge, Gauss' theorem gives its
// curvatures without the inverse of B.9: with tangents t and outward normals m of edges i -> j,
//
//   H = 1/F sum over edges of (w_j - w_i) sym(t m^T) + length dw/dm m m^T,
//   energy = F E h^3 / (24 (1 - nu^2)) ((1 - nu) H:H + nu (tr H)^2).
//
// Triangles that share an edge share its turn about the edge, whatever their angle to each other,
// so that folds keep their angles. A corner's w is its displacement along the normal.
//
// Misprints of appendix B: the factors of B.5 and B.8 have 1 - 2 nu where plane stress has 1 - nu,
// and that of B.8, with h counted once, is h^3/12 and not h^3/3; the last column of B.9 is
// 2 y sin(phi) for edges.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "lib/fem/tet/block_csr.h"
#include "volumes/io/solid/solid_mesh.h"

namespace supple {

/// V, B and BV.
enum class SheetKind { stretch, bending, both };

/// A sheet on a set of faces of the mesh, by the set's name.
struct ElasticSheet {
  std::string faces;
  SheetKind kind = SheetKind::both;
  double young_kpa = 0, poisson = 0, thickness_mm = 0;

  /// Throws InputError.
  void validate() const;
};

/// Stiffness of a triangle's nine displacements in mN/mm, corner by corner, and its three turns
/// about the edges 01, 12, 20, in this direction; of turns in mN mm.
using TriangleMatrix = std::array<std::array<double, 12>, 12>;
TriangleMatrix triangle_stiffness(const std::array<Vec3d, 3>& corners, const ElasticSheet& sheet);

/// Any number of sheets.
class ShellTriangles {
 public:
  struct Triangle {
    std::array<NodeIndex, 3> corners;
    std::int32_t sheet;
  };
  ShellTriangles() = default;
  /// Edges whose turns are unknowns get nodes of their own from `first_node` on, each for three of
  /// them. `positions` of all other nodes.
  ShellTriangles(const std::vector<ElasticSheet>& sheets, const std::vector<Triangle>& triangles,
                 const std::vector<Vec3d>& positions);

  const std::vector<ElasticSheet>& sheets() const { return m_sheets; }
  const std::vector<Triangle>& triangles() const { return m_triangles; }
  /// The same sheets where they bend, with the same edges, as sheets that do not stretch.
  ShellTriangles bending_alone(const std::vector<Vec3d>& positions) const;
  std::size_t triangle_count() const { return m_triangles.size(); }
  /// Number of nodes whose components are turns.
  std::size_t turn_node_count() const { return (m_edges.size() + 2) / 3; }
  /// Ends of the edges with turns, ascending; the n-th is component n % 3 of turn node n / 3, about
  /// the direction from the lower to the higher end, in rad.
  const std::vector<std::array<NodeIndex, 2>>& edges() const { return m_edges; }
  const NodeSets& sets() const { return m_sets; }
  double area_mm2(std::size_t triangle) const { return m_areas[triangle]; }

  /// Adds the stiffness times a part per sheet, and inertia per sheet in mN/mm^4: the consistent
  /// mass of the corners, and of an edge's turn the rotary inertia h^3/12 of a third of its
  /// triangles. Components of the last node that are no edge's turn are alone, and as the last
  /// edge's turn is.
  void add_to(BlockCsr& matrix, const std::vector<double>& parts,
              const std::vector<double>& inertia) const;
  /// Stretch of each triangle from its displaced corners: its area by that at rest.
  std::vector<double> area_ratios(const std::vector<Vec3d>& displaced) const;
  std::size_t bytes() const;

 private:
  void fill_last_node(BlockCsr& matrix) const;

  NodeIndex m_first_node = 0;
  std::vector<ElasticSheet> m_sheets;
  std::vector<Triangle> m_triangles;
  std::vector<TriangleMatrix> m_matrices;
  std::vector<double> m_areas;
  std::vector<std::array<NodeIndex, 2>> m_edges;
  std::vector<std::array<std::int32_t, 3>> m_edges_of;  // per triangle; -1 where it has none
  NodeSets m_sets;
};

}  // namespace supple
