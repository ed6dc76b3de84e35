// Triangle meshes and networks of lines, written as STL, PLY, OBJ or legacy VTK files in LPS mm.
// Cost: the file's bytes.
#pragma once

#include <string>

#include "volumes/io/mesh/triangle_mesh.h"

namespace supple {

/// Writes `.stl` (binary, floats, no lines), `.ply` (binary, doubles), `.obj` or `.vtk` (text, all
/// digits); the extension decides. read_network() gives the same mesh back, an STL file its
/// corners anew. Throws InputError for another extension and for a network without triangles in an
/// STL file, and as OutputFile.
void write_mesh(const std::string& path, const LineNetwork& network);

/// Throws InputError, naming `field` of `place`, unless write_mesh() knows the extension of a path.
void require_mesh_name(const std::string& path, const std::string& place, const std::string& field);

}  // namespace supple
