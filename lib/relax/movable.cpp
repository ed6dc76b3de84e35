#include "lib/relax/movable.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lib/relax/brick_springs.h"

namespace supple {

namespace {

void clear_bit(std::vector<BrickMask>& masks, Slot slot) {
  const unsigned offset = slot % kBrickVoxels;
  masks[slot / kBrickVoxels][offset / 64] &= ~(std::uint64_t(1) << (offset % 64));
}

void find_rigid_clusters(const Body& body, const LinkTable& table, Movable& elements) {
  std::vector<std::uint32_t> bricks(elements.movable.size());
  std::iota(bricks.begin(), bricks.end(), 0u);
  elements.rigid = find_clusters(body, table, bricks, [&](int kind, Slot low, Slot high) {
    return table.is_rigid(kind, body.classes[low], body.classes[high]);
  });
  for (std::size_t c = 0; c < elements.rigid.count(); ++c) {
    const auto begin = elements.rigid.members.begin() + elements.rigid.first[c];
    const auto end = elements.rigid.members.begin() + elements.rigid.first[c + 1];
    const bool moves = std::all_of(begin, end, [&](Slot slot) { return elements.moves(slot); });
    for (auto slot = begin; slot != end; ++slot) {
      clear_bit(elements.single, *slot);
      if (!moves) clear_bit(elements.movable, *slot);
    }
  }
}

}  // namespace

std::size_t Movable::bytes() const {
  return rigid.bytes() + (movable.capacity() + single.capacity()) * sizeof(BrickMask);
}

Movable find_movable(const Body& body, const LinkTable& table, const SlotSet& anchored,
                     bool has_clusters) {
  Movable elements;
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    elements.movable.push_back(body.elements.mask(b));
  }
  anchored.for_each([&](Slot slot) { clear_bit(elements.movable, slot); });
  elements.single = elements.movable;
  if (has_clusters && table.has_rigid()) find_rigid_clusters(body, table, elements);
  return elements;
}

bool has_rest(const Body& body, int coordinate) {
  return std::any_of(body.rest.begin(), body.rest.end(),
                     [&](const auto& axis) { return !axis[std::size_t(coordinate)].empty(); });
}

std::pair<std::vector<Bound>::const_iterator, std::vector<Bound>::const_iterator> bounds_in(
    const std::vector<Bound>& bounds, std::size_t brick) {
  const auto before = [](const Bound& bound, std::size_t slot) { return bound.slot < slot; };
  const auto first = std::lower_bound(bounds.begin(), bounds.end(), brick * kBrickVoxels, before);
  return {first, std::lower_bound(first, bounds.end(), (brick + 1) * kBrickVoxels, before)};
}

double over_relaxation(int pass, int extent) {
  return 2 - std::max(3.0 / (2 * pass + 3), 2.0 / (extent + 2));
}

int largest_extent(const BrickTopology& elements) {
  const IndexBox& bounds = elements.active_bounds();
  int extent = 0;
  for (int axis = 0; axis < 3; ++axis) {
    extent = std::max(extent, bounds.hi[axis] - bounds.lo[axis] + 1);
  }
  return extent;
}

}  // namespace supple
