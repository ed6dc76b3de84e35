// Nodes of the voxel mesh: around every corner of the lattice one per piece of the up to eight
// voxels there that linked faces join. Blocks are done side by side; the numbers do not depend on
// the number of threads.
#pragma once

#include "lib/body/body.h"
#include "lib/fem/voxel/hex_mesh.h"

namespace supple {

/// Sets the corners and fills node_begin of a mesh whose elements and blocks are those of the body.
void number_voxel_nodes(const Body& body, HexMesh& mesh, const Progress* progress);

}  // namespace supple
