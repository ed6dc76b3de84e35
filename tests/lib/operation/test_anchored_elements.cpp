// Pieces that have lost their anchors, found by whole bricks of bits.
#include <random>

#include <gtest/gtest.h>

#include "lib/operation/anchored_elements.h"
#include "tests/lib/test_bodies.h"

namespace supple::test {
namespace {

/// The same from element to element.
std::vector<BrickMask> brute_anchored(const Body& body, const std::vector<BrickMask>& left,
                                      const SlotSet& anchors) {
  std::vector<BrickMask> reached(left.size(), BrickMask{});
  std::vector<Slot> open;
  const auto reach = [&](Slot slot) {
    const std::size_t brick = slot / kBrickVoxels;
    const int offset = int(slot % kBrickVoxels);
    if (!mask_test(left[brick], offset) || mask_test(reached[brick], offset)) return;
    mask_set(reached[brick], offset);
    open.push_back(slot);
  };
  anchors.for_each(reach);
  while (!open.empty()) {
    const Slot slot = open.back();
    open.pop_back();
    for (int side = 0; side < 6; ++side) {
      Slot other;
      if (neighbour_slot(body.elements, body.cuts, slot, side / 2, side % 2 == 1, other)) {
        reach(other);
      }
    }
  }
  return reached;
}

TEST(PropertyAnchoredElements, BitsReachWhatAFloodFromElementToElementReaches) {
  std::mt19937 random(5);
  for (int n = 0; n < 60; ++n) {
    Body body = body_of(homogeneous({19, 17, 21}, 1.2, 0.8, 0.3));
    std::vector<BrickMask> left;
    std::vector<Slot> anchors;
    for (std::size_t b = 0; b < body.elements.brick_count(); ++b) left.push_back({});
    for_each_element(body.elements, [&](Slot slot) {
      // About a third is gone: clusters of all sizes are left.
      if (random() % 100 >= unsigned(n)) mask_set(left[slot / kBrickVoxels], int(slot % 512));
      if (random() % 400 == 0) anchors.push_back(slot);
      for (int axis = 0; axis < 3; ++axis) {
        if (random() % 4 == 0) body.cuts.cut(slot / kBrickVoxels, int(slot % 512), axis);
      }
    });
    const SlotSet held(anchors);
    EXPECT_EQ(anchored_elements(body.elements, body.cuts, left, held),
              brute_anchored(body, left, held))
        << n;
  }
}

}  // namespace
}  // namespace supple::test
