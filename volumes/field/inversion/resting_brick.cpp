#include "volumes/field/inversion/resting_brick.h"

#include "volumes/grid/cell.h"
#include "volumes/grid/mask_steps.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

/// Place among the 27 bricks around a brick of that one step up along some axes.
std::size_t place_above(const Vec3i& up) {
  constexpr int kMiddle = 13;
  const int place = kMiddle + 9 * up.x + 3 * up.y + up.z;
  return std::size_t(place);
}

/// True if all voxels of the brick and of those above it are there.
bool is_inside(const Surroundings& around, const std::vector<std::uint8_t>& full) {
  for (int n = 0; n < 8; ++n) {
    const std::int32_t upper = around[place_above(cell_corner(n))];
    if (upper < 0 || full[std::size_t(upper)] == 0) return false;
  }
  return true;
}

}  // namespace

RestingBrick::RestingBrick(const BrickTopology& voxels, const std::vector<std::uint8_t>& full,
                           std::size_t b, const std::function<bool(std::int32_t)>& rests) {
  m_nodes.fill(~std::uint64_t(0));
  const Surroundings around = surroundings_of(voxels, b);
  if (rests(std::int32_t(b)) && is_inside(around, full)) return;
  const MasksAround masks = masks_around(
      around, [&](std::int32_t n) -> const BrickMask& { return voxels.mask(std::size_t(n)); });
  // Cells of the brick and of those below it.
  std::array<BrickMask, 8> cells{};
  for (int n = 0; n < 8; ++n) {
    const Vec3i down = cell_corner(n);
    if (n > 0 && !rests(around[place_above(-down)])) continue;
    std::array<BrickMask, 8> corners;
    for (int m = 0; m < 8; ++m) {
      corners[std::size_t(m)] = *masks[place_above(cell_corner(m) - down)];
    }
    cells[std::size_t(n)] = cells_in(corners);
  }
  m_cells = mask_count(cells[0]);
  if (!rests(std::int32_t(b))) cells[0] = {};
  m_nodes = corners_of(cells);
}

}  // namespace supple
