// The nearest point of a triangle mesh and the side of it on which a point lies.
//
// Triangles are found by an R-tree of Boost.Geometry (header-only, so that no start pays for it).
// The side is that of the angle-weighted normal of the face, edge or vertex that is nearest
// (Baerentzen and Aanaes 2005): right everywhere for closed meshes without self-intersections.
//
// Cost: 350 bytes and 1 us per triangle once; a query 2 to 4 us near the surface, up to 50 us at a
// distance from which many triangles are about equally far.
#pragma once

#include <memory>

#include "lib/contact/collider_contact.h"
#include "volumes/io/mesh/triangle_mesh.h"

namespace supple {

class MeshSurface {
 public:
  /// Corners at equal coordinates count as one. Throws InputError when no triangle has an area.
  explicit MeshSurface(const TriangleMesh& mesh);
  ~MeshSurface();

  /// Signed distance, negative behind the triangles' backs (which face inwards where they wind
  /// clockwise seen from outside). On the surface the normal is that of the face.
  SurfaceDistance distance_to(const Vec3d& pos_mm) const;
  /// True where the box around the mesh alone says that it is farther away than that.
  bool is_farther(const Vec3d& pos_mm, double distance_mm) const;

 private:
  struct Tree;
  std::unique_ptr<const Tree> m_tree;
};

}  // namespace supple
