#include "volumes/io/brick_store.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <tbb/parallel_for.h>

namespace supple {

namespace {

/// True when all voxels of the slab in the brick hold the first one's density. A NaN equals none.
bool is_constant(const Slab& slab, const Vec3i& origin, const Vec3i& extent) {
  const std::size_t row = std::size_t(slab.dims.x);
  const float* first = slab.values.data() + std::size_t(origin.y) * row + origin.x;
  const float density = *first;
  for (int k = 0; k < extent.z; ++k) {
    for (int j = 0; j < extent.y; ++j) {
      const float* values = first + (std::size_t(k) * slab.dims.y + j) * row;
      int equal = 0;
      for (int i = 0; i < extent.x; ++i) equal += values[i] == density;
      if (equal < extent.x) return false;
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

template <class Holds>
BrickMask BrickStore::Brick::mask_where(const Holds& holds) const {
  BrickMask mask{};
  if (values == nullptr && !holds(constant)) return mask;
  std::array<float, kBrickVoxels> filled;
  if (values == nullptr) copy_to(filled.data());
  const float* all = values == nullptr ? filled.data() : values.get();
  for (int word = 0; word < kBrickVoxels / 64; ++word) {
    for (int bit = 0; bit < 64; ++bit) {
      mask[word] |= std::uint64_t(holds(all[64 * word + bit])) << bit;
    }
  }
  return mask;
}

BrickStore::Brick BrickStore::brick_of(const Slab& slab, int bi, int bj) {
  Brick brick;
  brick.origin = slab.brick_origin(bi, bj);
  brick.extent = {std::min(kBrickDim, slab.dims.x - brick.origin.x),
                  std::min(kBrickDim, slab.dims.y - brick.origin.y), slab.depth};
  brick.constant = slab.values[std::size_t(brick.origin.y) * slab.dims.x + brick.origin.x];
  if (is_constant(slab, brick.origin, brick.extent)) return brick;
  brick.values = std::make_unique<float[]>(kBrickVoxels);
  slab.gather(bi, bj, brick.values.get());
  return brick;
}

void BrickStore::add(const Slab& slab, const std::function<bool(int bi, int bj)>& wants) {
  const int across = slab.bricks_x();
  std::vector<Brick> bricks(std::size_t(across) * slab.bricks_y());
  tbb::parallel_for(std::size_t(0), bricks.size(), [&](std::size_t n) {
    const int bi = int(n) % across, bj = int(n) / across;
    if (!wants(bi, bj)) return;
    bricks[n] = brick_of(slab, bi, bj);
  });
  const auto is_finite = [](float density) { return !std::isnan(density); };
  for (Brick& brick : bricks) {
    const bool is_kept = brick.values == nullptr ? brick.extent.x > 0 && is_finite(brick.constant)
                                                 : mask_count(brick.mask_where(is_finite)) > 0;
    if (is_kept) m_bricks.push_back(std::move(brick));
  }
}

BrickTopology BrickStore::above(float threshold) const {
  std::vector<Vec3i> origins(m_bricks.size());
  std::vector<BrickMask> masks(m_bricks.size());
  tbb::parallel_for(std::size_t(0), m_bricks.size(), [&](std::size_t n) {
    origins[n] = m_bricks[n].origin;
    masks[n] = m_bricks[n].mask_where([&](float density) { return density > threshold; });
  });
  return {std::move(origins), std::move(masks)};
}

DensityGrid BrickStore::take_grid(const BrickTopology& where, float background) {
  // Stored brick of each wanted one; what holds no finite wanted voxel drops out.
  std::vector<Vec3i> origins(m_bricks.size());
  std::vector<BrickMask> masks(m_bricks.size(), BrickMask{});
  tbb::parallel_for(std::size_t(0), m_bricks.size(), [&](std::size_t n) {
    const Brick& brick = m_bricks[n];
    origins[n] = brick.origin;
    const std::int32_t wanted = where.find(brick.origin);
    if (wanted < 0) return;
    masks[n] = brick.mask_where([](float density) { return !std::isnan(density); });
    for (int word = 0; word < 8; ++word) masks[n][word] &= where.mask(wanted)[word];
  });
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
