// The lattice cells that start in one source brick: displacements at their corners, gathered from
// the brick and its seven upper neighbours.
#pragma once

#include "volumes/field/inversion/cell_corners.h"
#include "volumes/field/offset_field.h"

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

/// True if a volume has one slice along some axis.
bool is_flat(const Vec3i& dims);
/// A body of one slice along some axis has no cells: its slice is repeated below and above. Others
/// come back as they are.
VectorBricks thickened(const VectorBricks& u, const Vec3i& dims);
BrickTopology thickened(const BrickTopology& voxels, const Vec3i& dims);

/// Sources further apart than this, in voxels, are not the same place found twice.
constexpr double kSamePlace = 0.5;

/// Content of a place in a source cell. Where several places come to one, tissue hides air.
enum class Content : std::uint8_t {
  air,      // the nearest voxel is no element
  surface,  // it is one, but not every corner of the cell
  tissue    // every corner is an element
};

/// The content of the cells of one source brick. Cost: 0.1 µs.
class CellContents {
 public:
  /// `elements`: thickened where the volume has one slice; null: everything is tissue.
  CellContents(const BrickTopology* elements, const Vec3i& origin);

  /// Content at a place relative to `origin`, 0 … 8 along every axis.
  Content at(const Vec3d& place) const;
  /// The best that a place in the cell with this offset in the brick could be.
  Content best_in(int cell) const;
  /// Cells of which every corner is an element.
  const BrickMask& tissue_cells() const { return m_tissue; }
  bool is_all_tissue() const { return m_is_all_tissue; }
  /// Bits z = 0…8 of the elements in row (x, y) of the corners.
  unsigned elements(int x, int y) const { return m_rows[x][y]; }

 private:
  std::uint16_t m_rows[kCornerDim][kCornerDim];
  BrickMask m_tissue{};
  bool m_is_all_tissue;
};

}  // namespace supple
