#include "lib/model/voxel_corners.h"

namespace supple {

Corners VoxelCorners::operator()(Slot slot) const {
  if (m_refined == nullptr) {
    const std::size_t block = slot / kBrickVoxels;
    return m_mesh.corners_in(block, element_at(m_mesh, block, int(slot % kBrickVoxels)));
  }
  const std::vector<std::int32_t> parts =
      m_refined->parts_of(m_mesh, voxel_of(m_body.elements, slot));
  const int last = m_refined->parts() - 1;
  Corners corners;
  for (std::size_t c = 0; c < 8; ++c) {
    const Vec3d high = place_of_corner(c);
    const int n = (int(high.x) * (last + 1) + int(high.y)) * (last + 1) + int(high.z);
    corners[c] = m_mesh.corners(parts[std::size_t(n * last)])[c];
  }
  return corners;
}

}  // namespace supple
