#include "lib/fem/voxel/loose_islands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace supple {

namespace {

/// Products of an island's six rigid motions over its held components.
struct RigidSight {
  std::array<std::array<double, 6>, 6> gram{};
  Vec3d about{0, 0, 0};
  bool has_any = false;
};

/// Relative pivots below this are rounding.
constexpr double kRankTolerance = 1e-9;

int rank_of(std::array<std::array<double, 6>, 6> gram) {
  // Motions scaled alike, then elimination with the largest pivot.
  std::array<double, 6> scale;
  for (int n = 0; n < 6; ++n) scale[n] = gram[n][n] > 0 ? 1 / std::sqrt(gram[n][n]) : 0;
  for (int n = 0; n < 6; ++n) {
    for (int m = 0; m < 6; ++m) gram[n][m] *= scale[n] * scale[m];
  }
  std::array<bool, 6> is_done{};
  for (int rank = 0; rank < 6; ++rank) {
    int pivot = -1;
    for (int n = 0; n < 6; ++n) {
      if (!is_done[n] && (pivot < 0 || gram[n][n] > gram[pivot][pivot])) pivot = n;
    }
    if (gram[pivot][pivot] < kRankTolerance) return rank;
    is_done[pivot] = true;
    for (int n = 0; n < 6; ++n) {
      if (is_done[n]) continue;
      const double factor = gram[n][pivot] / gram[pivot][pivot];
      for (int m = 0; m < 6; ++m) gram[n][m] -= factor * gram[pivot][m];
    }
  }
  return 6;
}

void see(const Vec3d& position, std::uint8_t bits, RigidSight& sight) {
  if (!sight.has_any) sight.about = position;
  sight.has_any = true;
  const Vec3d arm = position - sight.about;
  for (int a = 0; a < 3; ++a) {
    if ((bits >> a & 1) == 0) continue;
    // Component a of the motions: three translations, three rotations w x arm.
    const Vec3d turned[3] = {{0, -arm.z, arm.y}, {arm.z, 0, -arm.x}, {-arm.y, arm.x, 0}};
    std::array<double, 6> motion{};
    motion[a] = 1;
    for (int axis = 0; axis < 3; ++axis) motion[3 + axis] = turned[axis][a];
    for (int n = 0; n < 6; ++n) {
      for (int m = 0; m < 6; ++m) sight.gram[n][m] += motion[n] * motion[m];
    }
  }
}

}  // namespace

LooseCount hold_loose_islands(const HexMesh& voxels, bool holds, HeldBits& held) {
  const Islands islands = find_islands(voxels);
  std::map<std::int32_t, RigidSight> sights;
  for (std::size_t block = 0; block < voxels.block_count(); ++block) {
    for (std::int32_t e = voxels.element_begin[block]; e < voxels.element_begin[block + 1]; ++e) {
      const Corners corners = voxels.corners_in(block, e);
      for (int c = 0; c < 8; ++c) {
        const NodeIndex node = corners[c];
        // One visit per node is enough; what a block met first is met here again at least once.
        if (held[node] == 0 || node < voxels.node_begin[block]) continue;
        see(corner_position(voxels, std::int32_t(block), voxels.offset[e], c), held[node],
            sights[islands.of_node[node]]);
      }
    }
  }
  std::vector<char> is_loose(islands.count, 1);
  for (const auto& [island, sight] : sights) is_loose[island] = rank_of(sight.gram) < 6;
  LooseCount count;
  count.islands = islands.count;
  count.loose_islands = std::count(is_loose.begin(), is_loose.end(), 1);
  if (count.loose_islands == 0) return count;
  for (const std::int32_t island : islands.of_element) count.loose_elements += is_loose[island];
  for (NodeIndex n = 0; holds && n < voxels.node_count(); ++n) {
    if (is_loose[islands.of_node[n]]) held[n] = 7;
  }
  return count;
}

}  // namespace supple
