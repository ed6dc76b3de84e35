#include <cmath>

#include "volumes/base/text.h"
#include "volumes/grid/density_grid.h"

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

std::string void_values_text(const VolumeStatistics& statistics) {
  std::string text;
  if (statistics.nan_count > 0) text = with_count(statistics.nan_count, "NaN voxel");
  if (statistics.infinite_count > 0) {
    text += (text.empty() ? "" : " and ") + with_count(statistics.infinite_count, "infinite voxel");
  }
  return text;
}

}  // namespace supple
