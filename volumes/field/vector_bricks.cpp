#include <cmath>

#include "volumes/field/offset_field.h"
#include "volumes/grid/cell.h"
namespace supple {

VectorBrickFinder finder_of(const VectorBricks& field) {
  return [&field](const Vec3i& origin) -> VectorBrickView {
    const std::int32_t b = field.topology.find(origin);
    if (b < 0) return {};
    return {&field.topology.mask(std::size_t(b)), field.vectors.brick_or_zero(std::size_t(b))};
  };
}

bool VectorBricks::at(const Vec3i& voxel, Vec3f& vector) const {
  const std::int32_t b = topology.find(voxel);
  const int offset = brick_offset(voxel);
  if (b < 0 || !mask_test(topology.mask(b), offset)) return false;
  vector = vectors.brick_or_zero(std::size_t(b))[offset];
  return true;
}

bool VectorBricks::sample(const Vec3d& pos_index, Vec3d& vector) const {
  for (int a = 0; a < 3; ++a) {
    if (!(std::abs(pos_index[a]) < kMaxCoordinate)) return false;
  }
  const Vec3i lo = floor_voxel(pos_index);
  const Vec3d t = pos_index - Vec3d(lo);
  const Vec3d weight[2] = {Vec3d(1) - t, t};
  const std::int32_t first = topology.find(lo);
  const bool in_one_brick = ((lo.x & 7) < 7) && ((lo.y & 7) < 7) && ((lo.z & 7) < 7);

  Vec3d sum(0);
  for (int corner = 0; corner < 8; ++corner) {
    const auto [x, y, z] = cell_corner(corner);
    const double w = weight[x].x * weight[y].y * weight[z].z;
    if (w == 0) continue;
    const Vec3i voxel = lo + Vec3i(x, y, z);
    const std::int32_t brick = in_one_brick || corner == 0 ? first : topology.find(voxel);
    const int offset = brick_offset(voxel);
    if (brick < 0 || !mask_test(topology.mask(brick), offset)) return false;
    const Vec3f& v = vectors.brick_or_zero(std::size_t(brick))[offset];
    sum.x += w * v.x;
    sum.y += w * v.y;
    sum.z += w * v.z;
  }
  vector = sum;
  return true;
}

std::size_t VectorBricks::bytes() const {
  return topology.bytes() + vectors.bytes();
}

}  // namespace supple
