// Islands of a mesh whose rigid motions nothing prevents: their equations have no unique solution.
#pragma once

#include "lib/fem/cell_classes.h"
#include "lib/fem/hex_mesh.h"

namespace supple {

struct LooseCount {
  std::int64_t islands = 0;        // in all
  std::int64_t loose_islands = 0;  // with fewer than six of the rigid motions prevented
  std::int64_t loose_elements = 0;
};

/// Counts the loose islands and, if asked, holds all their nodes where they are. An island is loose
/// when the held components of its nodes leave one of its six rigid motions free.
LooseCount hold_loose_islands(const HexMesh& voxels, bool holds, HeldBits& held);

}  // namespace supple
