// Sets of elements against std::set.
#include <algorithm>
#include <climits>
#include <set>

#include <gtest/gtest.h>

#include "lib/body/slot_set.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

using Plain = std::set<Slot>;

Plain plain(const SlotSet& set) {
  Plain slots;
  set.for_each([&](Slot slot) { slots.insert(slot); });
  return slots;
}

std::vector<Slot> random_slots(std::mt19937& random, unsigned bricks, unsigned count) {
  std::vector<Slot> slots;
  for (unsigned n = 0; n < count; ++n) slots.push_back(Slot(random() % (bricks * kBrickVoxels)));
  return slots;
}

}  // namespace

TEST(PropertySlotSet, SetOperationsEqualThoseOfStdSet) {
  std::mt19937 random(5);
  for (int n = 0; n < 200; ++n) {
    const unsigned bricks = 1 + unsigned(random() % 6);
    const auto a = random_slots(random, bricks, unsigned(random() % 900));
    const auto b = random_slots(random, bricks, unsigned(random() % 900));
    const Plain in_a(a.begin(), a.end()), in_b(b.begin(), b.end());
    SlotSet sum(a), rest(a);
    const SlotSet other(b);
    ASSERT_EQ(plain(sum), in_a);
    ASSERT_EQ(sum.size(), in_a.size());

    Plain both, either = in_a, without = in_a;
    std::set_intersection(in_a.begin(), in_a.end(), in_b.begin(), in_b.end(),
                          std::inserter(both, both.end()));
    either.insert(in_b.begin(), in_b.end());
    for (const Slot slot : in_b) without.erase(slot);
    Slot common = 0;
    ASSERT_EQ(sum.first_common(other, common), !both.empty());
    if (!both.empty()) {
      ASSERT_EQ(common, *both.begin());
    }
    sum.add(other);
    rest.remove(other);
    ASSERT_EQ(plain(sum), either);
    ASSERT_EQ(plain(rest), without);
    for (const Slot slot : random_slots(random, bricks + 1, 50)) {
      ASSERT_EQ(sum.contains(slot), either.count(slot) == 1);
    }
    for (const SlotSet::Brick& entry : rest.bricks()) ASSERT_GT(mask_count(entry.mask), 0);
  }
}

TEST(PropertySlotSet, ElementsInABoxAreThoseThatItContains) {
  std::mt19937 random(6);
  for (int n = 0; n < cases(300); ++n) {
    const Block block = random_block(random, {40, 20, 20});
    const Body body = body_of(block);
    IndexBox box;
    for (int axis = 0; axis < 3; ++axis) {
      box.lo[axis] = block.origin[axis] - 6 + int(random() % 30);
      box.hi[axis] = box.lo[axis] + int(random() % 20);
      if (random() % 10 == 0) box.hi[axis] = INT_MAX;
      if (random() % 10 == 0) box.lo[axis] = INT_MIN;
    }
    Plain expected;
    for (int v = 0; v < block.size(); ++v) {
      Slot slot;
      if (!box.contains(block.voxel(v)) || !slot_of(body.elements, block.voxel(v), slot)) continue;
      expected.insert(slot);
    }
    ASSERT_EQ(plain(slots_in_box(body.elements, box)), expected);
  }
}
