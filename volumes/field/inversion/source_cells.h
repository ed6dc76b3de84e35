// The lattice cells that start in one source brick: displacements at their corners, gathered from
// the brick and its seven upper neighbours.
#pragma once

#include "volumes/field/inversion/deformed_cell.h"
#include "volumes/field/vector_bricks.h"

namespace supple {

/// Corners of the cells of a brick: 9^3 nodes.
constexpr int kCornerDim = kBrickDim + 1;

/// u at the corners, component by component and in rows of eight cells, so that the corners of
/// sixteen cells lie side by side; anything finite where invalid.
struct SourceCells {
  using Rows = float[3][kCornerDim][kCornerDim][kBrickDim];  // [component][x][y][z]

  Vec3i origin{0, 0, 0};     // lowest voxel of the brick
  BrickMask mask{};          // cells whose eight corners are valid
  alignas(64) Rows lower{};  // z = 0…7
  alignas(64) Rows upper{};  // z = 1…8

  Vec3f u(int x, int y, int z) const {
    const int shifted = z == kBrickDim;
    const Rows& rows = shifted ? upper : lower;
    z -= shifted;
    return {rows[0][x][y][z], rows[1][x][y][z], rows[2][x][y][z]};
  }
};

/// Gathers the cells of source brick b; false when none has eight valid corners.
bool gather_cells(const VectorBricks& u, std::size_t b, SourceCells& cells);

/// Pose corners of the cell with the given offset in the brick, relative to its lowest corner.
CellCorners cell_corners(const SourceCells& cells, int offset);

/// True when the eight corners of a cell carry the same displacement; it is returned in `shift`.
bool is_translated(const SourceCells& cells, int offset, Vec3f& shift);

/// All cells of brick b whose eight corners are valid.
BrickMask cell_mask(const BrickTopology& voxels, std::size_t b);

/// Bits z = 0…8 of the corners (x, y) of the set cells.
void corner_rows(const BrickMask& cells, std::uint16_t (&rows)[kCornerDim][kCornerDim]);

/// A body of one slice along some axis has no cells: its slice is repeated below and above. Other
/// fields come back as they are.
VectorBricks thickened(const VectorBricks& u, const Vec3i& dims);

}  // namespace supple
