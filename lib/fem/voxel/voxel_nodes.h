// Nodes of the voxel mesh: around every corner of the lattice one per piece of the up to eight
// voxels there that linked faces join. Blocks are done side by side; the numbers do not depend on
// the number of threads.
#pragma once

#include "lib/body/body.h"
#include "lib/fem/voxel/hex_mesh.h"

namespace supple {

/// Sets the corners and fills node_begin of a mesh whose elements and blocks are those of the body.
void number_voxel_nodes(const Body& body, const TouchingRule& rule, HexMesh& mesh,
                        const Progress* progress);

/// The element of the voxel mesh behind a face, if it has the face's nodes; or -1. `index` is of
/// the mesh's blocks.
std::int32_t element_across(const HexMesh& mesh, const BrickIndex& index, std::size_t block,
                            std::int32_t element, int axis, bool is_high);

}  // namespace supple
