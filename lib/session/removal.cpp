#include "lib/session/removal.h"

#include <algorithm>

#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/grid/labels.h"

namespace supple {

namespace {

/// Width in voxels of the densities kept around elements (docs/design.md, "The air").
constexpr int kShellVoxels = 2;

BrickTopology left_of(const BrickTopology& elements, const SlotSet& removed) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    BrickMask mask = elements.mask(b);
    if (const BrickMask* gone = removed.find(b)) {
      for (std::size_t word = 0; word < mask.size(); ++word) mask[word] &= ~(*gone)[word];
    }
    origins.push_back(elements.origin(b));
    masks.push_back(mask);
  }
  return {std::move(origins), std::move(masks)};
}

/// The values of the elements that are left, on their bricks.
template <class T>
void move_values(const BrickTopology& from, const BrickTopology& to, BrickArray<T>& values) {
  if (values.brick_count() == 0) return;
  BrickArray<T> moved(to.brick_count());
  for (std::size_t b = 0; b < to.brick_count(); ++b) {
    const T* old = values.brick(std::size_t(from.find(to.origin(b))));
    if (old == nullptr) continue;
    for_each_active(to.mask(b), [&](int offset) {
      if (old[offset] != 0) moved.touch(b)[offset] = old[offset];
    });
  }
  if (moved.empty()) moved.clear();
  values = std::move(moved);
}

LinkCuts moved_cuts(const BrickTopology& from, const BrickTopology& to, const LinkCuts& cuts) {
  LinkCuts moved;
  for (std::size_t b = 0; b < to.brick_count(); ++b) {
    const LinkCuts::BrickCuts* old = cuts.brick(std::size_t(from.find(to.origin(b))));
    for (int axis = 0; old != nullptr && axis < 3; ++axis) {
      for_each_active((*old)[std::size_t(axis)], [&](int offset) {
        const Vec3i low = to.origin(b) + brick_local(offset);
        Vec3i high = low;
        ++high[axis];
        if (to.is_active(low) && to.is_active(high)) moved.cut(b, offset, axis);
      });
    }
  }
  return moved;
}

DensityGrid left_densities(const State& state, const BrickTopology& left,
                           const BrickArray<double>& left_share) {
  const BrickTopology shell = dilate_inside(left, kShellVoxels, state.geometry.dims());
  const float air = state.density.background();
  return fill_density_grid(
      shell,
      [&](std::size_t b, float* out) {
        const std::int32_t old = state.density.bricks().find(shell.origin(b));
        const std::int32_t elements = state.elements.find(shell.origin(b));
        const std::int32_t kept = left.find(shell.origin(b));
        std::fill(out, out + kBrickVoxels, air);
        if (old < 0) return;
        const float* values = state.density.values(std::size_t(old));
        for_each_active(shell.mask(b), [&](int offset) {
          const bool was = elements >= 0 && mask_test(state.elements.mask(elements), offset);
          const bool is = kept >= 0 && mask_test(left.mask(kept), offset);
          if (is || !was) {
            out[offset] = values[offset];
          } else {
            const double share =
                left_share.at(std::size_t(elements) * kBrickVoxels + std::size_t(offset));
            out[offset] += float(share) * (values[offset] - air);
          }
        });
      },
      air);
}

void drop_lost_anchors(State& state) {
  const auto has_none = [&](const IndexBox& box) {
    return slots_in_box(state.elements, box).empty();
  };
  state.anchors.erase(std::remove_if(state.anchors.begin(), state.anchors.end(), has_none),
                      state.anchors.end());
  const auto counts = label_counts(state.labels);
  auto& labels = state.anchor_labels;
  labels.erase(std::remove_if(labels.begin(), labels.end(),
                              [&](std::int32_t label) { return counts.count(label) == 0; }),
               labels.end());
}

std::vector<Bound> moved_bounds(const BrickTopology& from, const BrickTopology& to,
                                const std::vector<Bound>& bounds) {
  std::vector<Bound> moved;
  for (const Bound& bound : bounds) {
    Slot slot;
    if (slot_of(to, voxel_of(from, bound.slot), slot))
      moved.push_back({slot, bound.value, bound.asks});
  }
  return moved;
}

}  // namespace

void RemovedElements::add(const SlotSet& more, const Selection* selection, const Body& body) {
  if (left_share.brick_count() == 0) left_share.resize(body.elements.brick_count());
  const Vec3d spacing = body.geometry.spacing_mm();
  const double voxel_mm = std::max({spacing.x, spacing.y, spacing.z});
  more.for_each([&](Slot slot) {
    double share = 0;
    if (selection != nullptr && selection->ball_index) {
      const double beyond_mm =
          beyond_ball_mm(*selection, body.geometry, voxel_of(body.elements, slot));
      share = std::clamp(1 + beyond_mm / voxel_mm, 0.0, 1.0);
    }
    if (slots.contains(slot)) share = std::min(share, left_share.at(slot));
    if (share != left_share.at(slot)) left_share.set(slot, share);
  });
  slots.add(more);
}

State without_elements(const State& state, const RemovedElements& removed) {
  State left = state;
  left.elements = left_of(state.elements, removed.slots);
  if (left.elements.empty()) {
    throw InputError({"", "remove", "all " + with_count(state.elements.active_count(), "element"),
                      "a part of the body"});
  }
  left.density = left_densities(state, left.elements, removed.left_share);
  for (BrickValues& q : left.q) move_values(state.elements, left.elements, q);
  if (state.beyond) {
    auto beyond = *state.beyond;
    for (BrickValues& values : beyond) move_values(state.elements, left.elements, values);
    left.beyond = std::make_shared<const std::array<BrickValues, 3>>(std::move(beyond));
  }
  for (auto& axis : left.rest) {
    for (BrickValues& rest : axis) move_values(state.elements, left.elements, rest);
  }
  for (auto& velocity : left.velocity_mm_s) move_values(state.elements, left.elements, velocity);
  move_values(state.elements, left.elements, left.labels);
  move_values(state.elements, left.elements, left.pieces);
  left.cuts = moved_cuts(state.elements, left.elements, state.cuts);
  drop_lost_anchors(left);
  return left;
}

SlotSet moved_to(const BrickTopology& from, const BrickTopology& to, const SlotSet& set) {
  std::vector<SlotSet::Brick> bricks;
  for (const SlotSet::Brick& entry : set.bricks()) {
    const std::int32_t b = to.find(from.origin(entry.brick));
    if (b < 0) continue;
    SlotSet::Brick moved{std::uint32_t(b), entry.mask};
    for (std::size_t word = 0; word < moved.mask.size(); ++word) {
      moved.mask[word] &= to.mask(std::size_t(b))[word];
    }
    bricks.push_back(moved);
  }
  return SlotSet(std::move(bricks));
}

Holds moved_to(const BrickTopology& from, const BrickTopology& to, const Holds& holds) {
  Holds moved;
  moved.anchored = moved_to(from, to, holds.anchored);
  for (std::size_t c = 0; c < 3; ++c) {
    moved.at_least[c] = moved_bounds(from, to, holds.at_least[c]);
    moved.at_most[c] = moved_bounds(from, to, holds.at_most[c]);
  }
  return moved;
}

}  // namespace supple
