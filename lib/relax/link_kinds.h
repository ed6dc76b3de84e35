// Links of a body by kind: 0, 1 and 2 along the axes i, j and k, then diagonals of faces, then
// those of cells. A link is visited once, from its low end, from which one step along its kind's
// direction leads to the high end.
#pragma once

#include <array>
#include <cstdint>

#include "lib/body/body.h"
#include "lib/body/diagonals.h"
#include "lib/body/link_masks.h"
#include "lib/body/slot_set.h"

namespace supple {

constexpr int kAxisKinds = 3, kLinkKinds = 13;

/// Direction of each kind from the low end to the high one; all lead to the later voxel.
constexpr std::array<int, kLinkKinds> kDirectionOfKind = {22, 16, 14, 15, 17, 19, 21,
                                                          23, 25, 18, 20, 24, 26};

/// Kind of a link that leaves a voxel in that direction or the opposite one.
constexpr int kind_of_direction(int direction) {
  const int upwards = direction > kNoStep ? direction : opposite_direction(direction);
  for (int kind = 0; kind < kLinkKinds; ++kind) {
    if (kDirectionOfKind[std::size_t(kind)] == upwards) return kind;
  }
  return -1;
}

/// Kinds of a body with 6, 18 or 26 links per voxel.
constexpr int kinds_of(int links) {
  return links / 2;
}

/// Rest stretch of a link's spring in coordinate c, 2^-16 voxel; that of a diagonal is always 0.
inline std::int32_t rest_of_link(const Body& body, int kind, int c, Slot low) {
  return kind < kAxisKinds ? body.rest[std::size_t(kind)][std::size_t(c)].at(low) : 0;
}

/// Calls `visit(kind, low, high)` for every diagonal whose low end lies in brick b.
template <class Visit>
void for_each_diagonal(const Body& body, int links, std::size_t b, Visit&& visit) {
  const BrickNeighbours bricks = neighbours_of(body.elements, b);
  LinkMasks masks;
  find_links(body.elements, body.cuts, links, bricks, masks);
  for (int kind = kAxisKinds; kind < kinds_of(links); ++kind) {
    const auto direction = std::size_t(kDirectionOfKind[std::size_t(kind)]);
    const LinkStep step = step_of_direction(int(direction));
    for_each_active(masks[direction], [&](int offset) {
      const Vec3i end = brick_local(offset) + Vec3i(step[0], step[1], step[2]);
      const std::int32_t other =
          bricks[std::size_t(direction_of_step(end.x >> 3, end.y >> 3, end.z >> 3))];
      visit(kind, Slot(b * kBrickVoxels) + Slot(offset),
            Slot(other) * kBrickVoxels + Slot(brick_offset(end)));
    });
  }
}

/// Calls `visit(kind, low, high)` for every link of these kinds whose low end lies in brick b.
template <class Visit>
void for_each_link(const Body& body, int links, std::size_t b, Visit&& visit) {
  for_each_link(body.elements, body.cuts, b, visit);
  if (links != 6) for_each_diagonal(body, links, b, visit);
}

/// Calls `visit(kind, upwards, other)` for every element that a link joins to `slot`; upwards: slot
/// is the link's low end.
template <class Visit>
void for_each_neighbour(const Body& body, int links, Slot slot, Visit&& visit) {
  if (links == 6) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const bool upwards : {false, true}) {
        Slot other;
        if (neighbour_slot(body.elements, body.cuts, slot, axis, upwards, other)) {
          visit(axis, upwards, other);
        }
      }
    }
    return;
  }
  for_each_linked(body.elements, body.cuts, links, slot, [&](int direction, Slot other) {
    visit(kind_of_direction(direction), direction > kNoStep, other);
  });
}

}  // namespace supple
