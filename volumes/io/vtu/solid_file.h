// Solids of hexahedra for other programs: VTK's XML unstructured grids (.vtu, binary, base64
// inline) and legacy VTK (.vtk, text, version 3.0, which SOFA and FEBio Studio read too). Format:
// VTK File Formats, vtk.org. Cost: the file in memory, 60 bytes per hexahedron of a .vtu and 150 of
// a .vtk, plus its arrays.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "volumes/base/progress.h"
#include "volumes/base/vec.h"

namespace supple {

/// Numbers of all points or all cells.
struct SolidArray {
  std::string name;
  int components = 1;
  bool are_whole = false;     // stored as 32-bit integers
  std::vector<float> values;  // components together
};

struct HexSolid {
  std::vector<Vec3d> points_lps_mm;
  std::vector<std::array<std::int32_t, 8>> hexahedra;  // in VTK's order of corners, right-handed
  std::vector<SolidArray> of_points, of_cells;
};

/// True for names that end in .vtu or .vtk.
bool is_solid_name(const std::string& path);

/// Writes atomically, in the format that the extension names. Throws SystemError, and as
/// AtomicFile; Cancelled.
void write_solid(const std::string& path, const HexSolid& solid, Progress* progress = nullptr);

}  // namespace supple
