// Islands of a mesh whose rigid motions nothing prevents: their equations have no unique solution.
#pragma once

#include "lib/fem/elastic_solid.h"
#include "lib/fem/voxel/hex_mesh.h"

namespace supple {

/// Counts the loose islands and, if asked, holds all their nodes where they are. An island is loose
/// when the held components of its nodes leave one of its six rigid motions free.
LooseCount hold_loose_islands(const HexMesh& voxels, bool holds, HeldBits& held);

}  // namespace supple
