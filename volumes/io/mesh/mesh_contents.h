// Table of contents of a mesh file, of surfaces and of solids.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

/// Numbers that a file attaches to its points or cells.
struct MeshArray {
  std::string name;
  int components = 1;
  bool is_of_cells = false;
};

struct MeshContents {
  std::string format;  // "stl", "ply", "obj", "vtk" or "vtu"
  std::int64_t points = 0;
  std::int64_t cells = 0;                           // triangles of formats that have no others
  Vec3d low_lps_mm{0, 0, 0}, high_lps_mm{0, 0, 0};  // box of the points
  std::vector<MeshArray> arrays;

  void take_box(const std::vector<Vec3d>& points_lps_mm);
};

/// True for names that end in .stl, .ply, .obj or .vtk, in any case of letters.
bool is_mesh_name(const std::string& path);
/// Reads one of them. Throws InputError as read_mesh, but needs no triangle.
MeshContents mesh_contents(const std::string& path);

}  // namespace supple
