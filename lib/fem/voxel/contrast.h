// How much stiffer some elements of a mesh are than others.
#pragma once

#include "lib/fem/nodal_loads.h"
#include "lib/fem/voxel/hex_mesh.h"
#include "lib/fem/voxel/voxel_material.h"

namespace supple {

/// Returns the largest shear modulus by the smallest, of elements that can move: not held as
/// wholes. 1 where none can.
double free_contrast(const HexMesh& mesh, const VoxelMaterial& material, const HeldBits& held);

}  // namespace supple
