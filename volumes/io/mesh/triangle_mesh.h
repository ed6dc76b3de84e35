// Triangle meshes and networks of lines, read from STL, PLY, OBJ and legacy VTK files.
//
// Own readers: libassimp 5.2.5 crashes on damaged PLY files, keeps coordinates as floats and
// lengthens every start of the program by 4 ms.
// Cost: the file's bytes plus 24 bytes per vertex and 12 per triangle; about 100 MB of text or 1 GB
// of binary data a second.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

struct TriangleMesh {
  std::vector<Vec3d> vertices_lps_mm;
  std::vector<std::array<int, 3>> triangles;  // indices of vertices
};

/// Reads `.stl` (binary or text), `.ply` (text, little or big-endian), `.obj` or `.vtk` (legacy,
/// text or binary); the extension decides. Coordinates are LPS mm, or RAS where the file's head
/// says SPACE=RAS, as 3D Slicer writes it. A polygon becomes a fan of triangles, right for convex
/// ones. Lines, points, normals, colours and materials are left out. Throws InputError: missing or
/// damaged file, unknown extension, an index without vertex, a coordinate that is not finite, no
/// triangle at all.
TriangleMesh read_mesh(const std::string& path);

/// Vertices joined by lines, beside any triangles.
struct LineNetwork {
  TriangleMesh mesh;
  std::vector<std::array<int, 2>> lines;  // indices of vertices; polylines piece by piece
};

/// Reads the files of read_mesh, and in them lines, too: `edge` elements of PLY (vertex1, vertex2),
/// `l` of OBJ, LINES of VTK and lines among the cells of its unstructured grids. Throws InputError
/// as read_mesh, but needs a line or a triangle only; and for an end of a line without vertex, or
/// for one twice.
LineNetwork read_network(const std::string& path);

}  // namespace supple
