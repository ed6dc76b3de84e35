#include "volumes/field/points/folded_places.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

// No place of a folded cell is further away; voxels.
constexpr double kFarthestPlace = 1e9;
constexpr double kMostPlaces = 1 << 24;

Vec3i brick_of(const Vec3i& voxel) {
  return {voxel.x & ~(kBrickDim - 1), voxel.y & ~(kBrickDim - 1), voxel.z & ~(kBrickDim - 1)};
}

}  // namespace

void FoldedPlaces::add(const Vec3i& cell, const CellCorners& corners) {
  Vec3d lo = corners.corner(0), hi = lo;
  for (int n = 1; n < 8; ++n) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], corners.p[a][n]);
      hi[a] = std::max(hi[a], corners.p[a][n]);
    }
  }
  const Vec3d extent = hi - lo + Vec3d(1);
  if (!(extent.x * extent.y * extent.z <= kMostPlaces)) {
    throw InputError({"", "displacement", "a cell torn over more than 2^24 voxels", "a motion"});
  }
  const Vec3i first = cell + floor_voxel(lo), last = cell + floor_voxel(hi);
  for (int x = first.x; x <= last.x; ++x) {
    for (int y = first.y; y <= last.y; ++y) {
      for (int z = first.z; z <= last.z; ++z) mark({x, y, z});
    }
  }
}

void FoldedPlaces::add(const Vec3i& node) {
  for (int n = 0; n < 8; ++n) mark(node - cell_corner(n));
}

void FoldedPlaces::mark(const Vec3i& voxel) {
  mask_set(m_bricks.try_emplace(brick_of(voxel), BrickMask{}).first->second, brick_offset(voxel));
}

bool FoldedPlaces::contains(const Vec3d& x) const {
  if (m_bricks.empty()) return false;
  for (int a = 0; a < 3; ++a) {
    if (!(std::abs(x[a]) < kFarthestPlace)) return false;
  }
  const Vec3i voxel = floor_voxel(x);
  const auto found = m_bricks.find(brick_of(voxel));
  return found != m_bricks.end() && mask_test(found->second, brick_offset(voxel));
}

}  // namespace supple
