#include "volumes/io/load/brick_store.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// Which bricks of a row hold one density all over; a NaN equals none. Goes along the slab's rows
/// as they lie in memory, which is several times as fast as from brick to brick.
std::vector<char> find_constant(const Slab& slab, int bj) {
  const int width = slab.dims.x, end = std::min((bj + 1) * kBrickDim, slab.dims.y);
  std::vector<float> first(width);
  std::vector<int> differs(width, 0);
  const float* corners = slab.row(bj * kBrickDim, 0);
  for (int i = 0; i < width; ++i) first[i] = corners[i / kBrickDim * kBrickDim];
  for (int k = 0; k < slab.depth; ++k) {
    for (int j = bj * kBrickDim; j < end; ++j) {
      const float* row = slab.row(j, k);
      for (int i = 0; i < width; ++i) differs[i] |= row[i] != first[i];
    }
  }
  std::vector<char> constant(slab.bricks_x(), 1);
  for (int i = 0; i < width; ++i) {
    if (differs[i] != 0) constant[i / kBrickDim] = 0;
  }
  return constant;
}

bool is_void(const Slab& slab, const SlabBrick& brick) {
  const auto is_nan = [](float density) { return std::isnan(density); };
  if (!is_nan(brick.constant)) return false;
  for (int k = 0; k < brick.extent.z; ++k) {
    for (int j = 0; j < brick.extent.y; ++j) {
      const float* row = slab.row(brick.origin.y + j, k) + brick.origin.x;
      if (!std::all_of(row, row + brick.extent.x, is_nan)) return false;
    }
  }
  return true;
}

void cut_row(const Slab& slab, int bj, SlabBrick* bricks) {
  const std::vector<char> constant = find_constant(slab, bj);
  for (int bi = 0; bi < slab.bricks_x(); ++bi) {
    const Vec3i origin = slab.brick_origin(bi, bj);
    SlabBrick brick = constant_brick(origin, slab.dims, slab.row(origin.y, 0)[origin.x]);
    if (!constant[bi]) {
      if (is_void(slab, brick)) continue;
      brick.leaf = DensityLeaf(origin);
      slab.gather(bi, bj, brick.leaf.values());
    }
    bricks[bi] = std::move(brick);
  }
}

BrickMask box_mask(const Vec3i& extent) {
  const std::uint64_t row = (std::uint64_t(1) << extent.z) - 1;
  BrickMask mask{};
  for (int x = 0; x < extent.x; ++x) {
    for (int y = 0; y < extent.y; ++y) mask[x] |= row << (8 * y);
  }
  return mask;
}

/// Eight flags, each 0 or 1, as the bits of a number: the product moves flag n to bit 56 + n.
std::uint64_t bits_of(const unsigned char* flags) {
  std::uint64_t bytes;
  std::memcpy(&bytes, flags, sizeof bytes);
  return bytes * 0x0102040810204080u >> 56;
}

template <class Holds>
BrickMask mask_where(const SlabBrick& brick, const Holds& holds) {
  BrickMask mask{};
  if (!brick.leaf) return holds(brick.constant) ? box_mask(brick.extent) : mask;
  const float* values = brick.leaf.values();
  for (int word = 0; word < 8; ++word) {
    unsigned char flags[64];
    for (int n = 0; n < 64; ++n) flags[n] = holds(values[64 * word + n]);
    for (int n = 0; n < 64; n += 8) mask[word] |= bits_of(flags + n) << n;
  }
  return mask;
}

}  // namespace

bool SlabBrick::is_all(float density) const {
  return !leaf && !is_void() && constant == density &&
         std::signbit(constant) == std::signbit(density);
}

BrickMask SlabBrick::within(double lo, double hi) const {
  // The outermost floats within the bounds: what is compared with them fills whole registers.
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float least = float(lo) < lo ? std::nextafter(float(lo), kInfinity) : float(lo);
  const float most = float(hi) > hi ? std::nextafter(float(hi), -kInfinity) : float(hi);
  return mask_where(*this,
                    [=](float density) { return bool((density >= least) & (density <= most)); });
}

BrickMask SlabBrick::above(float threshold) const {
  return mask_where(*this, [=](float density) { return density > threshold; });
}

DensityLeaf SlabBrick::take_leaf() {
  if (leaf) return std::move(leaf);
  DensityLeaf made(origin);
  std::fill_n(made.values(), kBrickVoxels, constant);
  return made;
}

SlabBrick constant_brick(const Vec3i& origin, const Vec3i& dims, float density) {
  SlabBrick brick;
  brick.origin = origin;
  for (int a = 0; a < 3; ++a) brick.extent[a] = std::min(kBrickDim, dims[a] - origin[a]);
  brick.constant = density;
  return brick;
}

std::vector<SlabBrick> bricks_of(const Slab& slab) {
  const std::size_t across = std::size_t(slab.bricks_x());
  std::vector<SlabBrick> bricks(across * slab.bricks_y());
  parallel_for(slab.bricks_y(), [&](int bj) { cut_row(slab, bj, bricks.data() + bj * across); });
  return bricks;
}

DensityGrid BrickStore::take_above(float background) {
  std::vector<BrickMask> masks(m_bricks.size());
  parallel_for(m_bricks.size(), [&](std::size_t n) {
    masks[n] = m_bricks[n].above(background);
    m_bricks[n].note_extremes(masks[n]);
  });
  return take_masked(std::move(masks), background);
}

DensityGrid BrickStore::take_grid(const BrickTopology& where, float background) {
  constexpr float kLowest = -std::numeric_limits<float>::infinity();  // only NaN is not above
  std::vector<BrickMask> masks(m_bricks.size(), BrickMask{});
  parallel_for(m_bricks.size(), [&](std::size_t n) {
    const std::int32_t wanted = where.find(m_bricks[n].origin);
    if (wanted < 0) return;
    masks[n] = m_bricks[n].above(kLowest);
    for (int word = 0; word < 8; ++word) masks[n][word] &= where.mask(wanted)[word];
    m_bricks[n].note_extremes(masks[n]);
  });
  return take_masked(std::move(masks), background);
}

/// Bricks with an empty mask are freed first.
DensityGrid BrickStore::take_masked(std::vector<BrickMask> masks, float background) {
  std::vector<Vec3i> origins(m_bricks.size());
  for (std::size_t n = 0; n < m_bricks.size(); ++n) origins[n] = m_bricks[n].origin;
  BrickTopology topology(std::move(origins), std::move(masks));
  std::vector<SlabBrick*> sources(topology.brick_count());
  for (SlabBrick& brick : m_bricks) {
    const std::int32_t b = topology.find(brick.origin);
    if (b >= 0)
      sources[b] = &brick;
    else
      brick.leaf = DensityLeaf();
  }
  const auto take = [&](std::size_t b) { return sources[b]->take_leaf(); };
  DensityGrid grid = assemble_density_grid(std::move(topology), take, background);
  m_bricks.clear();
  return grid;
}

}  // namespace supple
