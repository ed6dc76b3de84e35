// Hexahedra from voxels: one per voxel, or per block of 2^k voxels along each axis.
// Cost: some 20 ns per voxel and 150 bytes per element.
#pragma once

#include "lib/mesh/tets/mask_distance.h"
#include "volumes/io/solid/solid_mesh.h"

namespace supple {

/// Throws InputError for a block that is no power of 2 up to 64.
void require_block(int voxels);

/// Blocks are elements where at least half of their voxels belong to the set. Elements share the
/// nodes at their corners; the faces are as those of make_tets(). Throws InputError: a block that
/// is no power of 2 up to 64, or where no block is half full.
SolidMesh make_hexes(const VoxelMask& mask, int block, std::int32_t region = 1,
                     const std::string& name = "surface");

}  // namespace supple
