#include "volumes/field/offset_field.h"

namespace supple {

bool PointwiseOffsets::face(int /*piece*/, const Vec3d& /*x*/, const Vec3d& /*y*/,
                            Vec3d& /*normal*/, double& /*depth_mm*/) const {
  return false;
}

bool PointwiseOffsets::face_in_source(int /*piece*/, const Vec3d& /*y*/, Vec3d& /*normal*/,
                                      double& /*depth_mm*/) const {
  return false;
}

bool PointwiseOffsets::offset_beside(int /*piece*/, const Vec3d& /*place*/,
                                     Vec3d& /*offset*/) const {
  return false;
}

Vec3d PointwiseOffsets::pull_back_smoothly(int piece, const Vec3d& x, const Vec3d& y,
                                           const Vec3d& gradient) const {
  Vec3d pulled = gradient;
  for (int a = 0; a < 3; ++a) {
    Vec3d half(0), below, above;
    half[a] = 0.5;
    if (!offset_beside(piece, x - half, below) || !offset_beside(piece, x + half, above)) {
      return pull_back(piece, x, y, gradient);
    }
    pulled[a] += (above - below).dot(gradient);
  }
  return pulled;
}

void PointwiseOffsets::set_bricks(std::vector<Vec3i> origins) {
  BrickMask full;
  full.fill(~std::uint64_t(0));
  std::vector<BrickMask> masks(origins.size(), full);
  m_bricks = BrickTopology(std::move(origins), std::move(masks));
}

}  // namespace supple
