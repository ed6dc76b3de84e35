#include "volumes/io/brick_store.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace supple {

namespace {

/// True when all voxels within `extent` hold the first one's density.
bool is_constant(const float* values, const Vec3i& extent) {
  for (int i = 0; i < extent.x; ++i) {
    for (int j = 0; j < extent.y; ++j) {
      const float* column = values + ((i << 6) | (j << 3));
      for (int k = 0; k < extent.z; ++k) {
        if (column[k] != values[0]) return false;
      }
    }
  }
  return true;
}

}  // namespace

void BrickStore::Brick::copy_to(float* out) const {
  if (values != nullptr) {
    std::copy(values.get(), values.get() + kBrickVoxels, out);
    return;
  }
  std::fill(out, out + kBrickVoxels, std::numeric_limits<float>::quiet_NaN());
  for (int i = 0; i < extent.x; ++i) {
    for (int j = 0; j < extent.y; ++j) {
      float* column = out + ((i << 6) | (j << 3));
      std::fill(column, column + extent.z, constant);
    }
  }
}

BrickMask BrickStore::Brick::mask_where(const std::function<bool(float)>& holds) const {
  BrickMask mask{};
  if (values == nullptr && !holds(constant)) return mask;
  std::array<float, kBrickVoxels> all;
  copy_to(all.data());
  for (int offset = 0; offset < kBrickVoxels; ++offset) {
    if (holds(all[offset])) mask_set(mask, offset);
  }
  return mask;
}

void BrickStore::add(const Slab& slab, int bi, int bj) {
  auto values = std::make_unique<float[]>(kBrickVoxels);
  slab.gather(bi, bj, values.get());
  if (std::all_of(values.get(), values.get() + kBrickVoxels,
                  [](float density) { return std::isnan(density); })) {
    return;
  }
  Brick brick;
  brick.origin = slab.brick_origin(bi, bj);
  brick.extent = {std::min(kBrickDim, slab.dims.x - brick.origin.x),
                  std::min(kBrickDim, slab.dims.y - brick.origin.y), slab.depth};
  brick.constant = values[0];
  if (!is_constant(values.get(), brick.extent)) brick.values = std::move(values);
  m_bricks.push_back(std::move(brick));
}

BrickTopology BrickStore::above(float threshold) const {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (const Brick& brick : m_bricks) {
    origins.push_back(brick.origin);
    masks.push_back(brick.mask_where([&](float density) { return density > threshold; }));
  }
  return {std::move(origins), std::move(masks)};
}

DensityGrid BrickStore::take_grid(const BrickTopology& where, float background) {
  // Stored brick of each wanted one; what holds no finite wanted voxel drops out.
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (const Brick& brick : m_bricks) {
    const std::int32_t wanted = where.find(brick.origin);
    if (wanted < 0) continue;
    BrickMask mask = brick.mask_where([](float density) { return !std::isnan(density); });
    for (int word = 0; word < 8; ++word) mask[word] &= where.mask(wanted)[word];
    origins.push_back(brick.origin);
    masks.push_back(mask);
  }
  const BrickTopology topology(std::move(origins), std::move(masks));
  std::vector<Brick*> sources(topology.brick_count(), nullptr);
  for (Brick& brick : m_bricks) {
    const std::int32_t b = topology.find(brick.origin);
    if (b >= 0)
      sources[b] = &brick;
    else
      brick.values.reset();
  }
  DensityGrid grid = fill_density_grid(
      topology,
      [&](std::size_t b, float* values) {
        sources[b]->copy_to(values);
        sources[b]->values.reset();
      },
      background);
  m_bricks.clear();
  return grid;
}

}  // namespace supple
