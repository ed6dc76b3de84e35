#include "volumes/grid/density_grid.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "volumes/grid/density_grid_vdb.h"
#include "volumes/grid/density_leaf.h"

namespace supple {

namespace {

Vec3i to_vec(const openvdb::Coord& c) {
  return {c.x(), c.y(), c.z()};
}

BrickMask to_mask(const FloatLeaf::NodeMaskType& mask) {
  BrickMask words;
  for (int word = 0; word < 8; ++word) words[word] = mask.getWord<openvdb::Index64>(word);
  return words;
}

}  // namespace

DensityGrid::DensityGrid() : DensityGrid(make_density_grid({}, {}, 0)) {}

DensityGrid::DensityGrid(std::shared_ptr<const Vdb> vdb) : m_vdb(std::move(vdb)) {
  const openvdb::FloatTree& tree = m_vdb->grid->tree();
  m_background = tree.background();
  std::vector<const FloatLeaf*> leaves;
  leaves.reserve(tree.leafCount());
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    if (!leaf->valueMask().isOff()) leaves.push_back(&*leaf);
  }
  std::sort(leaves.begin(), leaves.end(),
            [](const FloatLeaf* a, const FloatLeaf* b) { return a->origin() < b->origin(); });
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  std::vector<const float*> values;
  values.reserve(leaves.size());
  for (const FloatLeaf* leaf : leaves) {
    origins.push_back(to_vec(leaf->origin()));
    masks.push_back(to_mask(leaf->valueMask()));
    values.push_back(leaf->buffer().data());
  }
  m_bricks = BrickTopology(std::move(origins), std::move(masks));
  m_values = std::make_shared<const std::vector<const float*>>(std::move(values));
}

DensityGrid::DensityGrid(std::shared_ptr<const Vdb> vdb, BrickTopology bricks,
                         std::vector<const float*> values, std::vector<BrickExtremes> extremes)
    : m_vdb(std::move(vdb)),
      m_bricks(std::move(bricks)),
      m_values(std::make_shared<const std::vector<const float*>>(std::move(values))),
      m_extremes(std::make_shared<const std::vector<BrickExtremes>>(std::move(extremes))),
      m_background(m_vdb->grid->tree().background()) {}

float DensityGrid::at(const Vec3i& voxel) const {
  const std::int32_t b = m_bricks.find(voxel);
  return b < 0 ? m_background : values(std::size_t(b))[brick_offset(voxel)];
}

std::size_t DensityGrid::bytes() const {
  const std::size_t extremes = m_extremes == nullptr ? 0 : m_extremes->capacity();
  return m_vdb->grid->memUsage() + m_bricks.bytes() + m_values->capacity() * sizeof(float*) +
         extremes * sizeof(BrickExtremes);
}

DensityGrid fill_density_grid(const BrickTopology& bricks,
                              const std::function<void(std::size_t b, float* out)>& fill,
                              float background) {
  const auto filled = [&](std::size_t b) {
    DensityLeaf leaf(bricks.origin(b));
    fill(b, leaf.values());
    return leaf;
  };
  return assemble_density_grid(bricks, filled, background);
}

DensityGrid make_density_grid(const BrickTopology& bricks, const std::vector<float>& values,
                              float background) {
  const auto copy_brick = [&](std::size_t b, float* out) {
    std::copy_n(values.data() + b * kBrickVoxels, kBrickVoxels, out);
  };
  return fill_density_grid(bricks, copy_brick, background);
}

std::size_t density_grid_bytes(const BrickTopology& bricks) {
  // Every node of OpenVDB's tree has a fixed size, so that four small trees tell all of them.
  const auto tree_bytes = [](const std::vector<Vec3i>& origins) {
    std::vector<BrickMask> masks(origins.size(), BrickMask{1});
    const BrickTopology topology(origins, masks);
    const auto zeros = [](std::size_t, float* out) { std::fill_n(out, kBrickVoxels, 0.0f); };
    return fill_density_grid(topology, zeros, 0).vdb().grid->memUsage();
  };
  const std::size_t empty = tree_bytes({}), single = tree_bytes({Vec3i(0)});
  const std::size_t leaf = tree_bytes({Vec3i(0), Vec3i(8, 0, 0)}) - single;
  const std::size_t lower = tree_bytes({Vec3i(0), Vec3i(128, 0, 0)}) - single - leaf;
  const std::size_t upper = single - empty - leaf - lower;

  const auto distinct = [&](int dim_log2) {
    std::set<std::tuple<int, int, int>> nodes;
    for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
      const Vec3i& o = bricks.origin(b);
      nodes.emplace(o.x >> dim_log2, o.y >> dim_log2, o.z >> dim_log2);
    }
    return nodes.size();
  };
  return empty + leaf * bricks.brick_count() + lower * distinct(7) + upper * distinct(12) +
         bricks.bytes() + bricks.brick_count() * (sizeof(float*) + sizeof(BrickExtremes));
}

DensityGrid restrict_to(const DensityGrid& grid, const BrickTopology& keep) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (std::size_t b = 0; b < grid.bricks().brick_count(); ++b) {
    const std::int32_t kept = keep.find(grid.bricks().origin(b));
    if (kept < 0) continue;
    BrickMask mask = grid.bricks().mask(b);
    for (int word = 0; word < 8; ++word) mask[word] &= keep.mask(kept)[word];
    origins.push_back(grid.bricks().origin(b));
    masks.push_back(mask);
  }
  const BrickTopology bricks(std::move(origins), std::move(masks));
  std::vector<float> values(bricks.brick_count() * kBrickVoxels);
  for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
    const float* source = grid.values(grid.bricks().find(bricks.origin(b)));
    std::copy(source, source + kBrickVoxels, values.begin() + b * kBrickVoxels);
  }
  return make_density_grid(bricks, values, grid.background());
}

}  // namespace supple
