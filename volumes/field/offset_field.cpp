#include "volumes/field/offset_field.h"

#include <cmath>

#include "volumes/field/split_offsets.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

// Step of central differences, in voxels. Pieces are smooth: the error is its square.
constexpr double kStep = 1.0 / 64;

}  // namespace

Vec3d SplitOffsets::pull_back(int piece, const Vec3d& x, const Vec3d& /*y*/,
                              const Vec3d& gradient) const {
  Vec3d result = gradient;
  for (int a = 0; a < 3; ++a) {
    Vec3d step(0), above, below;
    step[a] = kStep;
    if (!offset_of(piece, x + step, above) || !offset_of(piece, x - step, below)) continue;
    result[a] += (above - below).dot(gradient) / (2 * kStep);
  }
  return result;
}

Vec3d SplitOffsets::face_normal(int piece, const Vec3d& x) const {
  Vec3d normal(0);
  for (int a = 0; a < 3; ++a) {
    Vec3d step(0);
    step[a] = kStep;
    normal[a] = (depth_mm(piece, x + step) - depth_mm(piece, x - step)) / (2 * kStep);
    if (!std::isfinite(normal[a])) return Vec3d(0);
  }
  return normal;
}

bool SplitOffsets::face(int piece, const Vec3d& x, const Vec3d& /*y*/, Vec3d& normal,
                        double& depth) const {
  normal = face_normal(piece, x);
  depth = depth_mm(piece, x);
  return normal != Vec3d(0);
}

bool OffsetField::sample(const Vec3d& pos_index, Vec3d& offset) const {
  if (split != nullptr) {
    for (int a = 0; a < 3; ++a) {
      if (!(std::abs(pos_index[a]) < kMaxCoordinate)) return false;
    }
    const std::int32_t b = split->bricks().find(
        {int(std::floor(pos_index.x)), int(std::floor(pos_index.y)), int(std::floor(pos_index.z))});
    SplitOffsets::Sample found;
    if (b >= 0) {
      if (!split->sample(std::size_t(b), pos_index, found)) return false;
      offset = found.offset;
      return true;
    }
  }
  return o.sample(pos_index, offset);
}

bool OffsetField::source_of(const Vec3d& x, Vec3d& source) const {
  const Vec3i& dims = geometry.dims();
  Vec3d offset;
  if (!sample(x, offset) && !sample(within_border(x, dims), offset)) return false;
  source = within_border(x + offset, dims);
  for (int a = 0; a < 3; ++a) {
    if (source[a] < 0 || source[a] > dims[a] - 1) return false;
  }
  return true;
}

}  // namespace supple
