#include "volumes/field/pointwise_offsets.h"

namespace supple {

bool PointwiseOffsets::face(int /*piece*/, const Vec3d& /*x*/, const Vec3d& /*y*/,
                            Vec3d& /*normal*/, double& /*depth_mm*/) const {
  return false;
}

bool PointwiseOffsets::face_in_source(const Vec3d& /*y*/, Vec3d& /*normal*/,
                                      double& /*depth_mm*/) const {
  return false;
}

void PointwiseOffsets::set_bricks(std::vector<Vec3i> origins) {
  BrickMask full;
  full.fill(~std::uint64_t(0));
  std::vector<BrickMask> masks(origins.size(), full);
  m_bricks = BrickTopology(std::move(origins), std::move(masks));
}

}  // namespace supple
