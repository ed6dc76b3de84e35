#include "volumes/field/inversion/resting_brick.h"

#include "volumes/grid/cell.h"
#include "volumes/grid/padded_rows.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

/// Whether the brick's own voxels and all those above it are there.
bool is_inside(const BrickTopology& voxels, std::size_t b) {
  if (!is_full(voxels.mask(b))) return false;
  for (int n = 1; n < 8; ++n) {
    const std::int32_t upper = voxels.find(voxels.origin(b) + cell_corner(n) * kBrickDim);
    if (upper < 0 || !is_full(voxels.mask(std::size_t(upper)))) return false;
  }
  return true;
}

}  // namespace

RestingBrick::RestingBrick(const BrickTopology& voxels, std::size_t b,
                           const std::function<bool(std::int32_t)>& rests) {
  m_nodes.fill(~std::uint64_t(0));
  if (rests(std::int32_t(b)) && is_inside(voxels, b)) return;
  const Surroundings around = surroundings_of(voxels, b);
  const PaddedRows<1> padded = padded_rows<1>(
      around, [&](std::int32_t n) -> const BrickMask& { return voxels.mask(std::size_t(n)); });
  // Complete cells that start at -1 … 7 along every axis: bit z + 1 of row (x + 1, y + 1).
  unsigned cells[kBrickDim + 1][kBrickDim + 1];
  m_cells = 0;
  for (int x = 0; x <= kBrickDim; ++x) {
    for (int y = 0; y <= kBrickDim; ++y) {
      const unsigned row = padded.rows[x][y] & padded.rows[x + 1][y] & padded.rows[x][y + 1] &
                           padded.rows[x + 1][y + 1];
      cells[x][y] = row & row >> 1 & 0x1ff;
      if (x > 0 && y > 0) m_cells += __builtin_popcount(cells[x][y] >> 1);
      // Only those of bricks that rest count from here on; 13 is the middle of `around`.
      const int side = 13 - (x == 0 ? 9 : 0) - (y == 0 ? 3 : 0);
      const unsigned of_resting = (rests(around[std::size_t(side)]) ? 0x1feu : 0u) |
                                  (rests(around[std::size_t(side - 1)]) ? 1u : 0u);
      cells[x][y] &= of_resting;
    }
  }
  for (int x = 0; x < kBrickDim; ++x) {
    m_nodes[std::size_t(x)] = 0;
    for (int y = 0; y < kBrickDim; ++y) {
      const unsigned row = cells[x][y] | cells[x + 1][y] | cells[x][y + 1] | cells[x + 1][y + 1];
      m_nodes[std::size_t(x)] |= std::uint64_t((row | row >> 1) & 0xff) << (8 * y);
    }
  }
}

}  // namespace supple
