// A mesh body: nodes with explicit connectors of two, three and four nodes (thesis chapter 5), the
// counterpart of the voxel body, whose connectors are implied by the lattice. Membranes, networks
// and tetrahedral meshes are mesh bodies; models share the node state and nothing else.
//
// Memory: 48 bytes per node for rest positions and present ones, 24 more once something moves with
// a velocity, and 4 bytes per index of a connector.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "volumes/base/vec.h"
#include "volumes/io/mesh/triangle_mesh.h"

namespace supple {

/// Indices of the nodes that a connector joins.
using LinkNodes = std::array<int, 2>;
using TriangleNodes = std::array<int, 3>;
using TetrahedronNodes = std::array<int, 4>;

/// Positions in LPS mm, velocities in mm/s.
struct MeshBody {
  std::vector<Vec3d> rest_mm;
  std::vector<Vec3d> pos_mm;         // as many as rest_mm
  std::vector<Vec3d> velocity_mm_s;  // as many, or empty: nothing moves
  std::vector<LinkNodes> links;      // unique, lower index first, ascending
  std::vector<TriangleNodes> triangles;
  std::vector<TetrahedronNodes> tetrahedra;

  std::size_t node_count() const { return rest_mm.size(); }
  std::size_t bytes() const;
};

/// A body at rest; the edges of the triangles become the links. Vertices are not merged: those of
/// an STL file, which stores every corner anew, are joined by merge_equal_vertices first. Throws
/// InputError: an index without vertex, a triangle with a corner twice, a coordinate that is not
/// finite.
MeshBody make_mesh_body(const TriangleMesh& mesh);
/// A mesh with lines, which become links beside the edges of its triangles. Throws as above.
MeshBody make_mesh_body(const LineNetwork& network);
/// A network of links between points; doubled links count once. Throws InputError as above.
MeshBody make_network(std::vector<Vec3d> points_lps_mm, const std::vector<LinkNodes>& links);
/// A body at rest; the edges of the tetrahedra become the links, their outer faces (those of one
/// tetrahedron only) the triangles, which face outwards. Throws InputError as above.
MeshBody make_tetrahedral_body(std::vector<Vec3d> points_lps_mm,
                               std::vector<TetrahedronNodes> tetrahedra);

/// A mesh whose vertices of equal coordinates are one. Triangles that collapse are left out.
struct MergedMesh {
  TriangleMesh mesh;
  std::vector<int> merged_from;  // per vertex of the source, its vertex in `mesh`
};
MergedMesh merge_equal_vertices(const TriangleMesh& mesh);

}  // namespace supple
