// Dilation of a brick topology by Chebyshev rings: a box filter, one axis at a time, on the bits of
// the masks. Cost: about 0.2 µs per brick, axis and ring, plus three rebuilt brick tables.
#include <stdexcept>

#include "volumes/grid/brick_topology.h"
#include "volumes/grid/mask_steps.h"

namespace supple {

namespace {

/// The middle one of three bricks in a row after `rings` steps along their axis. Bricks further
/// away do not reach it within a brick's length.
BrickMask dilated(BrickMask below, BrickMask mask, BrickMask above, int axis, int rings) {
  for (int ring = 0; ring < rings; ++ring) {
    const BrickMask up = shifted_up(mask, below, axis), down = shifted_down(mask, above, axis);
    add(shifted_up(below, BrickMask{}, axis), below);
    add(shifted_down(above, BrickMask{}, axis), above);
    add(up, mask);
    add(down, mask);
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
