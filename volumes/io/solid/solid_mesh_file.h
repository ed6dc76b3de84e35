// Solid meshes in files of other programs, LPS mm, stiffness in kPa (so that forces come in mN):
//
//   .vtu   VTK, ParaView: nodes, elements; arrays "region", "material", "young_kpa", "poisson"
//   .inp   CalculiX, Abaqus: all of a mesh; elements of a region, of a material and faces as sets
//   .feb   FEBio 4.0: all of a mesh; a part per region and material
//   .msh   Gmsh 2.2: all but stiffness; regions and face sets are physical groups
//
// VTK's files have no faces. The first two are read back.
// Cost: the text in pieces of a megabyte, 100 bytes per node and 60 per element of it; a .vtu
// whole.
#pragma once

#include <string>

#include "volumes/base/progress.h"
#include "volumes/io/solid/solid_mesh.h"

namespace supple {

/// True for names that end in .vtu, .inp, .feb or .msh.
bool is_solid_mesh_name(const std::string& path);

/// Writes atomically, in the format that the extension names. Throws InputError for another one,
/// SystemError, and as AtomicFile.
void write_solid_mesh(const std::string& path, const SolidMesh& mesh, Progress* progress = nullptr);

/// Reads a .vtu or .inp file: tetrahedra, hexahedra, and of quadratic ones the corners; regions,
/// materials, and of an .inp file the faces of elements. Other elements and keywords are left out.
/// Throws InputError: another extension, a damaged file, an element without its nodes, no element.
SolidMesh read_solid_mesh(const std::string& path);

}  // namespace supple
