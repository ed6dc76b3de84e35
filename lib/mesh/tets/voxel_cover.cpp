#include "lib/mesh/tets/voxel_cover.h"

#include "lib/mesh/tets/element_voxels.h"

namespace supple {

VoxelCover cover_of(const VoxelMask& mask, const SolidMesh& mesh) {
  // A voxel around the box: elements may reach half a voxel beyond it.
  const Vec3i lo = mask.box.lo - Vec3i(1), dims = mask.dims() + Vec3i(2);
  std::vector<std::uint8_t> is_covered(
      std::size_t(dims.x) * std::size_t(dims.y) * std::size_t(dims.z), 0);
  const std::vector<Vec3d> places = index_places(mesh, mask.geometry);
  for (std::size_t e = 0; e < mesh.element_count(); ++e) {
    for_each_voxel(mesh, e, places, [&](const Vec3i& voxel) {
      const Vec3i at = voxel - lo;
      for (int a = 0; a < 3; ++a) {
        if (at[a] < 0 || at[a] >= dims[a]) return;
      }
      is_covered[(std::size_t(at.z) * std::size_t(dims.y) + std::size_t(at.y)) *
                     std::size_t(dims.x) +
                 std::size_t(at.x)] = 1;
    });
  }
  std::int64_t covered = 0;
  for (const std::uint8_t is : is_covered) covered += is;
  VoxelCover cover;
  const Vec3i inner = mask.dims();
  std::size_t n = 0;
  for (int k = 0; k < inner.z; ++k) {
    for (int j = 0; j < inner.y; ++j) {
      const std::uint8_t* row =
          is_covered.data() +
          (std::size_t(k + 1) * std::size_t(dims.y) + std::size_t(j + 1)) * std::size_t(dims.x) + 1;
      for (int i = 0; i < inner.x; ++i, ++n) cover.both += mask.inside[n] & row[i];
    }
  }
  cover.lost = mask.count() - cover.both;
  cover.gained = covered - cover.both;
  return cover;
}

VoxelMask uncovered_voxels(const VoxelMask& mask, const VoxelLabel& label_of,
                           const SolidMesh& mesh) {
  VoxelMask left = mask;
  const std::vector<Vec3d> places = index_places(mesh, mask.geometry);
  for (std::size_t e = 0; e < mesh.element_count(); ++e) {
    for_each_voxel(mesh, e, places, [&](const Vec3i& voxel) {
      if (!left.holds(voxel) || (label_of && label_of(voxel) != mesh.region_of[e])) return;
      left.inside[left.number(voxel)] = 0;
    });
  }
  return left;
}

}  // namespace supple
