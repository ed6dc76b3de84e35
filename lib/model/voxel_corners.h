// Nodes of a mesh at the corners of a body's voxels, whether these are its elements or have parts.
#pragma once

#include "lib/body/body.h"
#include "lib/fem/voxel/hex_mesh.h"
#include "lib/model/refined_shape.h"
#include "volumes/grid/cell.h"

namespace supple {

/// Place of a corner in edges of the voxel: 0 or 1 along each axis.
inline Vec3d place_of_corner(std::size_t corner) {
  return Vec3d(cell_corner(int(corner)));
}

/// The nodes of a mesh that the corners of a body's voxels are.
class VoxelCorners {
 public:
  /// `refined`: the shape whose mesh it is; null: elements are voxels. All must outlive this.
  VoxelCorners(const HexMesh& mesh, const Body& body, const RefinedShape* refined)
      : m_mesh(mesh), m_body(body), m_refined(refined) {}

  /// The nodes of a voxel in the order of corners of elements.
  Corners operator()(Slot slot) const;
  /// Calls visit(node, part) for all nodes in or around the voxel; parts of its edges are 0 to 1.
  template <class Visit>
  void for_each_node(Slot slot, Visit&& visit) const;

  const HexMesh& mesh() const { return m_mesh; }
  const Body& body() const { return m_body; }
  bool is_refined() const { return m_refined != nullptr; }

 private:
  const HexMesh& m_mesh;
  const Body& m_body;
  const RefinedShape* m_refined;
};

template <class Visit>
void VoxelCorners::for_each_node(Slot slot, Visit&& visit) const {
  if (m_refined == nullptr) {
    const Corners corners = (*this)(slot);
    for (std::size_t c = 0; c < 8; ++c) visit(corners[c], place_of_corner(c));
    return;
  }
  const int parts = m_refined->parts();
  int n = 0;
  for (const std::int32_t e : m_refined->parts_of(m_mesh, voxel_of(m_body.elements, slot))) {
    const Vec3d low(Vec3i(n / (parts * parts), n / parts % parts, n % parts));
    const Corners corners = m_mesh.corners(e);
    for (std::size_t c = 0; c < 8; ++c) {
      visit(corners[c], (low + place_of_corner(c)) / double(parts));
    }
    ++n;
  }
}

}  // namespace supple
