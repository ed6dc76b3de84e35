#include "volumes/grid/volume.h"

#include <cmath>

namespace supple {

float sample_trilinear(const DensityGrid& grid, const Vec3d& pos_index, float outside) {
  const Vec3i lo = floor_voxel(pos_index);
  const Vec3d t = pos_index - Vec3d(lo);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3i step(corner & 1, (corner >> 1) & 1, corner >> 2);
    const double weight =
        (step.x ? t.x : 1 - t.x) * (step.y ? t.y : 1 - t.y) * (step.z ? t.z : 1 - t.z);
    if (weight == 0) continue;
    const Vec3i voxel = lo + step;
    sum += weight * (grid.bricks().is_active(voxel) ? grid.at(voxel) : outside);
  }
  return float(sum);
}

}  // namespace supple
