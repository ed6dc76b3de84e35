#include "volumes/io/load/values_at.h"

#include <algorithm>

#include "volumes/io/bytes/value_type.h"
#include "volumes/io/load/slice_values.h"

namespace supple {

std::vector<float> values_at(VolumeFile& file, const std::vector<Vec3i>& voxels) {
  const VolumeHeader& header = file.header();
  const Vec3i& dims = header.geometry.dims();
  const std::size_t count = std::size_t(dims.x) * dims.y;
  std::vector<char> stored(count * bytes_of(header.type));
  std::vector<float> densities(count), found(voxels.size());
  int last = -1;
  for (const Vec3i& voxel : voxels) last = std::max(last, voxel.z);
  for (int k = 0; k <= last; ++k) {
    file.read_slice(stored.data());
    const auto is_here = [k](const Vec3i& voxel) { return voxel.z == k; };
    if (std::none_of(voxels.begin(), voxels.end(), is_here)) continue;
    densities_of(header, stored.data(), count, densities.data());
    for (std::size_t n = 0; n < voxels.size(); ++n) {
      const Vec3i& voxel = voxels[n];
      if (is_here(voxel)) found[n] = densities[std::size_t(voxel.y) * dims.x + voxel.x];
    }
  }
  return found;
}

}  // namespace supple
