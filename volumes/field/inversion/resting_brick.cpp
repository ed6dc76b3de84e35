#include "volumes/field/inversion/resting_brick.h"

#include "volumes/grid/cell.h"
#include "volumes/grid/mask_steps.h"
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
  const std::array<BrickMask, 27> masks = masks_around(
      around, [&](std::int32_t n) -> const BrickMask& { return voxels.mask(std::size_t(n)); });
  // Of the brick and those below it, 13 being the middle of `around`.
  std::array<BrickMask, 8> cells{};
  for (int n = 0; n < 8; ++n) {
    const Vec3i down = cell_corner(n);
    const int lowest = 13 - 9 * down.x - 3 * down.y - down.z;
    if (n > 0 && !rests(around[std::size_t(lowest)])) continue;
    std::array<BrickMask, 8> corners;
    for (int m = 0; m < 8; ++m) {
      const Vec3i up = cell_corner(m);
      const int above = lowest + 9 * up.x + 3 * up.y + up.z;
      corners[std::size_t(m)] = masks[std::size_t(above)];
    }
    cells[std::size_t(n)] = cells_in(corners);
  }
  m_cells = mask_count(cells[0]);
  if (!rests(std::int32_t(b))) cells[0] = {};
  m_nodes = corners_of(cells);
}

}  // namespace supple
