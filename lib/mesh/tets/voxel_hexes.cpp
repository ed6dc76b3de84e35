#include "lib/mesh/tets/voxel_hexes.h"

#include <unordered_map>

#include "lib/mesh/tets/solid_faces.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

constexpr int kLargestBlock = 64;
constexpr int kVtkCorners[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                   {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

/// Voxels of the set in every block, blocks i fastest.
std::vector<int> voxels_of_blocks(const VoxelMask& mask, int block, const Vec3i& blocks) {
  std::vector<int> counts(std::size_t(blocks.x) * std::size_t(blocks.y) * std::size_t(blocks.z));
  const Vec3i dims = mask.dims();
  std::size_t n = 0;
  for (int k = 0; k < dims.z; ++k) {
    for (int j = 0; j < dims.y; ++j) {
      const std::size_t row =
          (std::size_t(k / block) * std::size_t(blocks.y) + std::size_t(j / block)) *
          std::size_t(blocks.x);
      for (int i = 0; i < dims.x; ++i, ++n) counts[row + std::size_t(i / block)] += mask.inside[n];
    }
  }
  return counts;
}

}  // namespace

void require_block(int voxels) {
  require(voxels >= 1 && voxels <= kLargestBlock && (voxels & (voxels - 1)) == 0, "hex", voxels,
          "1, 2, 4 … 64 voxels");
}

SolidMesh make_hexes(const VoxelMask& mask, int block, std::int32_t region,
                     const std::string& name) {
  require_block(block);
  if (mask.box.empty()) throw InputError({"", "voxels", "none", "one at least"});
  Vec3i blocks;
  for (int a = 0; a < 3; ++a) blocks[a] = (mask.dims()[a] + block - 1) / block;
  const std::vector<int> counts = voxels_of_blocks(mask, block, blocks);
  SolidMesh mesh;
  std::unordered_map<Vec3i, std::int32_t, VoxelHash> nodes;
  const bool is_mirrored = mask.geometry.determinant() < 0;
  for (std::size_t b = 0; b < counts.size(); ++b) {
    if (2 * counts[b] < block * block * block) continue;
    const Vec3i at(int(b % std::size_t(blocks.x)),
                   int(b / std::size_t(blocks.x) % std::size_t(blocks.y)),
                   int(b / std::size_t(blocks.x) / std::size_t(blocks.y)));
    std::array<std::int32_t, 8> hex{};
    for (std::size_t c = 0; c < 8; ++c) {
      // In a left-handed grid bottom and top change places, so that volumes stay positive.
      const int* step = kVtkCorners[is_mirrored ? c ^ 4U : c];
      const Vec3i corner = at + Vec3i(step[0], step[1], step[2]);
      const auto [found, is_new] =
          nodes.try_emplace(corner, std::int32_t(mesh.nodes_lps_mm.size()));
      if (is_new) {
        mesh.nodes_lps_mm.push_back(mask.geometry.world_from_index(
            Vec3d(mask.box.lo) + Vec3d(corner) * double(block) - Vec3d(0.5)));
      }
      hex[c] = found->second;
    }
    mesh.hexes.push_back(hex);
  }
  if (mesh.hexes.empty()) {
    throw InputError({"", "hex", std::to_string(block) + " voxels, of which no block is half full",
                      "smaller blocks"});
  }
  mesh.region_of.assign(mesh.hexes.size(), region);
  mesh.faces = faces_of_regions(mesh, {{region, name}});
  return mesh;
}

}  // namespace supple
