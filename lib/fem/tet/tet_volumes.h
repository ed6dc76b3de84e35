// Tetrahedra of a body as finite elements of linear elasticity: nodes, stiffness and mass, forces
// of swelling and gravity, and what displacements mean inside them.
//
//   linear           four nodes, thesis B.10 (tet_shape.h); locks as nu comes near 1/2
//   nodal_pressure   the same nodes; strains belong to each tetrahedron, but the dilatation that
//                    lambda resists is a mean over all tetrahedra around a node (of one material):
//                    Bonet & Burton, Commun. Numer. Meth. Engng 14, 437-449, 1998. It does not
//                    lock; a node is coupled with its neighbours' neighbours, so that rows are four
//                    times as long
//   quadratic        ten nodes, four points of integration, straight edges
//
// The dilatation of a node p is d_p = sum V_e div u_e / sum V_e over its tetrahedra, its volume V_p
// is a quarter of theirs, and the energy is sum V_e mu eps:eps + sum V_p lambda d_p^2 / 2. The part
// with mu needs nothing else to be stable; a lambda below 0 stays with each tetrahedron.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "lib/fem/element_state.h"
#include "lib/fem/tet/block_csr.h"
#include "lib/fem/tet/tet_shape.h"
#include "volumes/io/solid/solid_mesh.h"

namespace supple {

enum class TetElement { linear, nodal_pressure, quadratic };

/// Moduli of an element in kPa, and inertia in mN/mm^4 as ModuliTable has it.
struct TetModuli {
  double shear_kpa = 0, bulk_kpa = 0, inertia = 0;
  double lambda_kpa() const { return bulk_kpa - 2 * shear_kpa / 3; }
  /// The part of lambda that resists the dilatation of nodes, where elements have pressures there.
  double nodal_kpa() const { return std::max(0.0, lambda_kpa()); }
};

class TetVolumes {
 public:
  /// Patches of tetrahedra of one material around a node.
  struct Patches {
    std::vector<std::int32_t> material_of;
    std::vector<double> volume_mm3;
    std::vector<std::size_t> begin;  // as the sets' nodes
    std::vector<Vec3d> gradients;    // of d_p V_p by the displacement of each node
    std::vector<std::array<std::int32_t, 4>> of_element;
  };
  /// Throws InputError: hexahedra, a node that is not there, a volume that is not above 0.
  TetVolumes(const SolidMesh& mesh, TetElement element);

  TetElement element() const { return m_element; }
  std::size_t element_count() const { return m_shapes.size(); }
  /// Positions at rest; with ten nodes, those of the mesh come first and then the middles of edges.
  const std::vector<Vec3d>& positions() const { return m_positions; }
  /// Nodes per element: four corners, then the middles of edges 01, 02, 03, 12, 13, 23.
  const NodeSets& elements() const { return m_elements; }
  /// Sets of nodes that are coupled beyond that, around each node. Empty but for nodal_pressure.
  const NodeSets& patches() const { return m_patches; }
  const Patches& patch_table() const { return m_patch; }
  /// Points of integration of an element, which have equal parts of its volume.
  std::size_t point_count() const { return m_element == TetElement::quadratic ? 4 : 1; }
  /// Gradients of the shape functions at such a point.
  std::array<Vec3d, 10> point_gradients(std::size_t element, std::size_t point) const;
  /// The node in the middle of an edge; -1 where there is none.
  NodeIndex middle_of(NodeIndex a, NodeIndex b) const;
  double volume_mm3(std::size_t element) const { return m_shapes[element].volume_mm3; }
  std::int32_t material_of(std::size_t element) const { return m_material_of[element]; }

  /// Adds the stiffness, and inertia times the consistent mass, of moduli per material.
  void add_to(BlockCsr& matrix, const std::vector<TetModuli>& of_material) const;
  /// Adds forces of a pressure inside each element, V p grad N: free of load, it swells by p / K.
  void add_swelling(const std::vector<double>& pressure_kpa, std::vector<double>& force_mn) const;
  /// Adds those of a force per volume of each material.
  void add_body_force(const std::vector<Vec3d>& mn_per_mm3, std::vector<double>& force_mn) const;

  /// grad u, d u_i / d x_j in row i, at the element's centre.
  Matrix9 gradient_at_centre(std::size_t element, const std::vector<double>& u_mm) const;
  /// Mean states; `pressure_kpa` is the swelling, per element or empty.
  std::vector<ElementState> states(const std::vector<double>& u_mm,
                                   const std::vector<TetModuli>& of_material,
                                   const std::vector<double>& pressure_kpa) const;
  /// The least det F of all elements; with ten nodes, of their corners and points of integration.
  double least_det_f(const std::vector<double>& u_mm) const;
  /// Volume of the displaced body.
  double displaced_volume_mm3(const std::vector<double>& u_mm) const;
  std::size_t bytes() const;

 private:
  using Bary = std::array<double, 4>;
  void make_middles();
  void make_patches();
  void add_linear(BlockCsr& matrix, const std::vector<TetModuli>& of_material) const;
  void add_patches(BlockCsr& matrix, const std::vector<TetModuli>& of_material) const;
  void add_quadratic(BlockCsr& matrix, const std::vector<TetModuli>& of_material) const;
  std::array<Vec3d, 10> gradients_at(std::size_t element, const Bary& at) const;
  Matrix9 gradient_at(std::size_t element, const Bary& at, const std::vector<double>& u_mm) const;
  std::vector<double> patch_dilatations(const std::vector<double>& u_mm) const;

  TetElement m_element;
  std::vector<Vec3d> m_positions;
  std::vector<TetShape> m_shapes;
  std::vector<std::int32_t> m_material_of;
  NodeSets m_elements, m_patches;
  Patches m_patch;
  std::vector<std::array<NodeIndex, 3>> m_middles;  // ends, ascending, and the middle; sorted
};

}  // namespace supple
