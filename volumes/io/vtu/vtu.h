// Meshes of solids that have moved, as ParaView, FEBio, SOFA and CalculiX (by its converters) write
// them: VTK's XML unstructured grids (`.vtu`), with a vector per point that says where it has gone.
// Points are at rest; places and vectors are mm in LPS.
// Format: VTK File Formats, vtk.org, "XML File Formats".
#pragma once

#include <array>
#include <string>
#include <vector>

#include "volumes/base/vec.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/mesh/mesh_contents.h"

namespace supple {

struct MovedSolid {
  std::vector<Vec3d> points_lps_mm;  // at rest
  std::vector<Vec3d> moved_mm;       // one per point
  std::vector<std::array<int, 4>> tetrahedra;
};

/// True if the first bytes of a file are those of a VTU file.
bool is_vtu(const std::string& head);
/// Whether they are those of VTK's XML image data (`.vti`).
bool is_vti(const std::string& head);

/// Text, or binary data inline or appended, in base64 or raw, plain or by zlib, of either byte
/// order. The vectors are the points' array named displacement(s), disp or u, in any case of
/// letters, else the only one of three components. Hexahedra, wedges and pyramids become
/// tetrahedra, and quadratic cells those of their corners. Throws InputError: another content,
/// vectors that cannot be told, cells of faces and lines alone, an index without point, numbers
/// that are not finite.
MovedSolid read_vtu(const std::string& path);

/// Points, cells and arrays of such a file. Throws InputError for what is none.
MeshContents vtu_contents(const std::string& path);

/// The motion as a warp of resample direction on a grid: where a tetrahedron lies now, the vector
/// back to where its content was, linear inside of it and the shortest where several lie; 0 outside
/// of the solid, which is exact where its surface stays. Throws InputError where there is no grid.
/// Cost: that of the mesh, and about 10 ns per grid point and tetrahedron around it.
std::unique_ptr<VolumeFile> open_vtu(const std::string& path, const Geometry* grid);

}  // namespace supple
