// The displacement in the air around a body with cuts: from either side of a cut on its own.
#include "volumes/field/cuts/cut_body.h"
#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/grid/padded_rows.h"

namespace supple {

namespace {

constexpr int kRings = 2;
// Beside a cut a voxel may be this many rings from the elements of its own side.
constexpr int kRingsOfSide = 4;

}  // namespace

void extend_beside_cuts(VectorBricks& u, const CutBody& body) {
  // The second ring sees four voxels far.
  std::vector<Vec3i> voxels;
  for (const Vec3i& cell : body.parted_cells()) {
    for (int n = 0; n < 512; ++n) {
      const Vec3i voxel = cell + brick_local(n) - Vec3i(3);
      const int ring = u.topology.is_active(voxel) ? body.ring(voxel) : 0;
      if (ring >= 1 && ring <= kRings) voxels.push_back(voxel);
    }
  }
  sort_unique(voxels);
  std::unordered_map<Vec3i, int, VoxelHash> later;  // rings from the elements of their side
  const auto ring_of = [&](const Vec3i& voxel) {
    const auto found = later.find(voxel);
    return found != later.end() ? found->second : body.ring(voxel);
  };
  for (int ring = 1; ring <= kRingsOfSide; ++ring) {
    for (const Vec3i& voxel : voxels) {
      const std::int32_t b = u.topology.find(voxel);
      const int offset = brick_offset(voxel);
      if (b < 0 || !mask_test(u.topology.mask(std::size_t(b)), offset)) continue;
      if (ring_of(voxel) != ring) continue;
      Extrapolation extrapolation;
      const auto value_at = [&](const Vec3i& from, const Vec3i& to, Vec3f& value) {
        return u.at(to, value) && ring_of(to) < ring && body.connects(from, to);
      };
      for (int n = 0; n < 27; ++n) {
        const Vec3i beside = voxel + Vec3i(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
        Vec3f near, far;
        if (n == 13 || !value_at(voxel, beside, near)) continue;
        if (value_at(beside, 2 * beside - voxel, far)) {
          extrapolation.add_row(near, far);
        } else {
          extrapolation.add(near);
        }
      }
      if (extrapolation.empty()) {
        later[voxel] = ring + 1;
        continue;
      }
      u.vectors.touch(std::size_t(b))[offset] = extrapolation.value();
    }
  }
}

}  // namespace supple
