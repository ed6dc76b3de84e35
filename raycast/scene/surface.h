// Triangle meshes as pictures need them: without triangles that have no area, with a normal at
// every corner. A corner's normal is the mean of those triangles around its vertex that lie within
// the crease angle of its own, weighted by their angles there (G. Thuermer and C. Wuethrich,
// Computing vertex normals from polygonal facets, Journal of Graphics Tools 3(1), 1998); so that a
// rod of eight sides is round and its ends are flat. Vertices at the same place count as one, as
// STL files repeat them.
// Cost: about 3 µs and 60 bytes per triangle.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "volumes/io/mesh/triangle_mesh.h"

namespace supple {

/// A mesh and its look. Opacity is that of one layer: a closed body is seen through two.
struct Surface {
  TriangleMesh mesh;
  std::array<double, 3> rgb{0.75, 0.78, 0.82};  // 0…1, sRGB
  double opacity = 1;                           // 0…1

  /// Throws InputError: colour or opacity outside 0…1, a vertex that is not finite, a triangle
  /// without its vertices, no triangle with an area.
  void validate(const std::string& file) const;
};

struct SurfaceTriangle {
  std::array<int, 3> vertices;
  std::array<Vec3f, 3> normals;  // unit, at the corners
  Vec3f face_normal;             // unit
};

/// The triangles that have an area; normals follow the winding, counter-clockwise from outside.
std::vector<SurfaceTriangle> surface_triangles(const TriangleMesh& mesh);

}  // namespace supple
