// Differences of a displacement between elements that are linked: central, one-sided at the surface
// and at cuts, none along an axis where neither neighbour is there.
// Cost: 10 ns per neighbour that is looked up.
#pragma once

#include "volumes/field/columns.h"
#include "volumes/field/offset_field.h"
#include "volumes/grid/link_cuts.h"

namespace supple {

/// Second derivatives of u along the axes of the grid: [a][b] is d2 u / da db.
using SecondDerivatives = std::array<std::array<Vec3d, 3>, 3>;

/// Reads u at elements, index space. The references must outlive it.
class LinkedElements {
 public:
  LinkedElements(const Displacement& u, const BrickTopology& elements, const LinkCuts& cuts)
      : m_dims(u.geometry.dims()), m_u(u.u), m_elements(elements), m_cuts(cuts) {}

  Vec3d at(const Vec3i& voxel) const;
  /// Whether there is a link from a voxel to the next one along the axis.
  bool is_linked(const Vec3i& voxel, int axis) const;
  /// grad u at an element: column a is du / da.
  Columns gradient(const Vec3i& voxel) const;
  /// det(I + grad u) at an element.
  double jacobian(const Vec3i& voxel) const;
  /// Central second differences at an element; false where a neighbour by face or edge is missing
  /// or cut off. Those along an axis on which the grid has one voxel are 0.
  bool second_derivatives(const Vec3i& voxel, SecondDerivatives& D) const;
  /// Whether the cell above the voxel is complete and folded.
  bool is_folded(const Vec3i& voxel) const;

 private:
  bool is_linked_to_side(const Vec3i& voxel, int axis, int side) const;
  bool mixed_derivative(const Vec3i& voxel, int a, int b, Vec3d& mixed) const;
  Vec3d derivative(const Vec3i& voxel, int axis) const;

  Vec3i m_dims;
  const VectorBricks& m_u;
  const BrickTopology& m_elements;
  const LinkCuts& m_cuts;
};

}  // namespace supple
