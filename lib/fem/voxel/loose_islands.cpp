#include "lib/fem/voxel/loose_islands.h"

#include <algorithm>
#include <map>
#include <vector>

#include "lib/fem/rigid_sight.h"

namespace supple {

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
        sights[islands.of_node[node]].see(
            corner_position(voxels, std::int32_t(block), voxels.offset[e], c), held[node]);
      }
    }
  }
  std::vector<char> is_loose(islands.count, 1);
  for (const auto& [island, sight] : sights) is_loose[island] = !sight.prevents_all();
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
