// Dilation of a brick topology by Chebyshev rings: a box filter, one axis at a time, on the bits of
// the masks. Cost: about 0.2 µs per brick, axis and ring, plus three rebuilt brick tables.
#include <stdexcept>

#include "volumes/grid/brick_topology.h"

namespace supple {

namespace {

// A word holds the (j, k) plane of one i: bit 8 j + k.
constexpr std::uint64_t kFirstK = 0x0101010101010101u;
constexpr std::uint64_t kLastK = kFirstK << 7;

/// Moves every voxel one step up the axis and brings in the last plane of the brick below.
BrickMask shifted_up(const BrickMask& mask, const BrickMask& below, int axis) {
  BrickMask out;
  for (int i = 0; i < kBrickDim; ++i) {
    switch (axis) {
      case 0:
        out[i] = i > 0 ? mask[i - 1] : below[kBrickDim - 1];
        break;
      case 1:
        out[i] = mask[i] << 8 | below[i] >> 56;
        break;
      default:
        out[i] = (mask[i] & ~kLastK) << 1 | (below[i] & kLastK) >> 7;
    }
  }
  return out;
}

BrickMask shifted_down(const BrickMask& mask, const BrickMask& above, int axis) {
  BrickMask out;
  for (int i = 0; i < kBrickDim; ++i) {
    switch (axis) {
      case 0:
        out[i] = i < kBrickDim - 1 ? mask[i + 1] : above[0];
        break;
      case 1:
        out[i] = mask[i] >> 8 | above[i] << 56;
        break;
      default:
        out[i] = (mask[i] & ~kFirstK) >> 1 | (above[i] & kFirstK) << 7;
    }
  }
  return out;
}

void unite(BrickMask& mask, const BrickMask& other) {
  for (int word = 0; word < 8; ++word) mask[word] |= other[word];
}

/// The middle one of three bricks in a row after `rings` steps along their axis. Bricks further
/// away do not reach it within a brick's length.
BrickMask dilated(BrickMask below, BrickMask mask, BrickMask above, int axis, int rings) {
  for (int ring = 0; ring < rings; ++ring) {
    const BrickMask up = shifted_up(mask, below, axis), down = shifted_down(mask, above, axis);
    unite(below, shifted_up(below, BrickMask{}, axis));
    unite(above, shifted_down(above, BrickMask{}, axis));
    unite(mask, up);
    unite(mask, down);
  }
  return mask;
}

BrickTopology dilate_axis(const BrickTopology& topology, int axis, int rings) {
  const BrickMask none{};
  const auto mask_of = [&](std::int32_t b) { return b < 0 ? none : topology.mask(b); };
  Vec3i step(0);
  step[axis] = kBrickDim;
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  origins.reserve(topology.brick_count() * 2);
  masks.reserve(topology.brick_count() * 2);
  for (std::size_t b = 0; b < topology.brick_count(); ++b) {
    const Vec3i& origin = topology.origin(b);
    const BrickMask& mask = topology.mask(b);
    const std::int32_t below = topology.neighbour(b, 2 * axis);
    const std::int32_t above = topology.neighbour(b, 2 * axis + 1);
    origins.push_back(origin);
    masks.push_back(dilated(mask_of(below), mask, mask_of(above), axis, rings));

    // A gap is filled once: by the brick beneath it, or by the one above when there is no other.
    if (above < 0) {
      origins.push_back(origin + step);
      masks.push_back(dilated(mask, none, mask_of(topology.find(origin + step * 2)), axis, rings));
    }
    if (below < 0 && topology.find(origin - step * 2) < 0) {
      origins.push_back(origin - step);
      masks.push_back(dilated(none, none, mask, axis, rings));
    }
  }
  return {std::move(origins), std::move(masks)};
}

}  // namespace

BrickTopology dilate(const BrickTopology& topology, int rings) {
  if (rings < 0 || rings > kBrickDim) throw std::invalid_argument("dilate: rings must be 0 to 8");
  if (rings == 0 || topology.empty()) return topology;
  return dilate_axis(dilate_axis(dilate_axis(topology, 0, rings), 1, rings), 2, rings);
}

BrickTopology dilate_inside(const BrickTopology& topology, int rings, const Vec3i& dims) {
  const BrickTopology grown = dilate(topology, rings);
  const IndexBox box{{0, 0, 0}, dims - Vec3i(1)};
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (std::size_t b = 0; b < grown.brick_count(); ++b) {
    BrickMask mask{};
    for_each_active(grown.mask(b), [&](int offset) {
      const Vec3i voxel = grown.origin(b) + brick_local(offset);
      if (box.contains(voxel) || topology.is_active(voxel)) mask_set(mask, offset);
    });
    origins.push_back(grown.origin(b));
    masks.push_back(mask);
  }
  return {std::move(origins), std::move(masks)};
}

}  // namespace supple
