#include "volumes/grid/density_leaf.h"

#include "volumes/base/parallel.h"
#include "volumes/grid/density_grid_vdb.h"

namespace supple {

namespace {

FloatLeaf& leaf_of(void* node) {
  return *static_cast<FloatLeaf*>(node);
}

/// Makes the mask's voxels active and all others background.
void activate(FloatLeaf& leaf, const BrickMask& mask, float background) {
  float* const values = leaf.buffer().data();
  FloatLeaf::NodeMaskType node_mask;
  for (int word = 0; word < 8; ++word) {
    node_mask.getWord<openvdb::Index64>(word) = mask[word];
    for (std::uint64_t off = ~mask[word]; off != 0; off &= off - 1) {
      values[word * 64 + __builtin_ctzll(off)] = background;
    }
  }
  leaf.setValueMask(node_mask);
}

}  // namespace

DensityLeaf::DensityLeaf(const Vec3i& origin)
    : m_node(
          new FloatLeaf(openvdb::PartialCreate(), openvdb::Coord(origin.x, origin.y, origin.z))) {
  leaf_of(m_node.get()).buffer().allocate();
}

float* DensityLeaf::values() const {
  return leaf_of(m_node.get()).buffer().data();
}

void DensityLeaf::Free::operator()(void* node) const {
  delete &leaf_of(node);
}

DensityGrid assemble_density_grid(BrickTopology bricks,
                                  const std::function<DensityLeaf(std::size_t b)>& take,
                                  float background) {
  std::vector<DensityLeaf> leaves(bricks.brick_count());
  std::vector<const float*> values(leaves.size());
  std::vector<BrickExtremes> extremes(leaves.size());
  parallel_for(leaves.size(), [&](std::size_t b) {
    leaves[b] = take(b);
    activate(leaf_of(leaves[b].m_node.get()), bricks.mask(b), background);
    if (!leaves[b].m_extremes) leaves[b].note_extremes(bricks.mask(b));
    extremes[b] = *leaves[b].m_extremes;
    values[b] = leaves[b].values();
  });
  auto grid = make_grid<openvdb::FloatGrid>(background);
  grid->setName("density");
  auto accessor = grid->getAccessor();
  for (DensityLeaf& leaf : leaves) accessor.addLeaf(&leaf_of(leaf.m_node.release()));
  return DensityGrid(std::make_shared<DensityGrid::Vdb>(DensityGrid::Vdb{grid}), std::move(bricks),
                     std::move(values), std::move(extremes));
}

}  // namespace supple
