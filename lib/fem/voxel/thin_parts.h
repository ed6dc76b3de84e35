// Thin parts of a body, cut into pieces: elements in no cube of 6^3 elements, of whatever material.
// Thin bone inside soft tissue is no thin part: pieces of it cost iterations. Nor is a flap beside
// a cut of a thick body, since cubes do not see cuts.
//
// Pieces are connected elements of a cube of 4^3. Where they are more than 3000, or than one for
// 200 nodes of the body, those of larger cubes join; where they stay too many, as islands do, there
// are none: the motions of a sponge's pieces would be dearer to solve for than the sponge.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lib/fem/voxel/cell_classes.h"
#include "lib/fem/voxel/hex_mesh.h"
#include "volumes/base/progress.h"

namespace supple {

struct ThinParts {
  std::vector<std::int32_t> piece_of;  // per node: its piece, or -1
  std::size_t count = 0;               // pieces
};

/// Nodes that are held as a whole are in no piece. Throws Cancelled.
ThinParts thin_parts(const HexMesh& voxels, const HeldBits& held, const Progress* progress);

}  // namespace supple
