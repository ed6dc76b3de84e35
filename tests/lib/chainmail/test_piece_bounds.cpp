// Bounds that tissue puts on elements of rigid pieces, against relaxation of every link until
// nothing changes.
#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "lib/body/diagonals.h"
#include "lib/body/rigid_links.h"
#include "lib/chainmail/ecm.h"
#include "lib/chainmail/piece_bounds.h"
#include "tests/lib/test_bodies.h"

using namespace supple;
using namespace supple::test;

namespace {

using HeldPlaces = std::map<Slot, std::int32_t>;

/// The envelope of the places of held elements, as far as it lies beyond offsets `by` from these.
std::vector<std::int64_t> envelope_of_held(const Body& body, int c, bool raises, std::int64_t by,
                                           const HeldPlaces& held) {
  std::vector<std::int64_t> values(body.elements.brick_count() * kBrickVoxels);
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = body.q[std::size_t(c)].at(n) + by;
  const auto go = [&](Slot slot, std::int64_t value) {
    const bool is_further = raises ? value > values[slot] : value < values[slot];
    if (is_further) values[slot] = value;
    return is_further;
  };
  for (const auto& [slot, value] : held) go(slot, value);
  for (bool changed = true; changed;) {
    changed = false;
    for_each_element(body.elements, [&](Slot i) {
      for_each_linked(body.elements, body.cuts, body.slacks.links(), i, [&](int direction, Slot j) {
        // q_i - q_j <= fall
        const std::int32_t fall = body.slacks.fall(direction, c, body.classes[i], body.classes[j]);
        if (fall >= kUnlimitedSlack) return;
        changed |= raises ? go(j, values[i] - fall) : go(i, values[j] + fall);
      });
    });
  }
  return values;
}

/// A bent body with three pieces of one to three elements; some elements are fixed, held and
/// pushed.
struct HeldPieces {
  HeldPieces(std::mt19937& random, const Block& block) : body(body_of(block)) {
    for_each_element(body.elements, [&](Slot slot) { slots.push_back(slot); });
    std::shuffle(slots.begin(), slots.end(), random);
    drag(body, {Handle(voxel(0), some(random))}, {Region(voxel(1))});
    std::vector<RigidPiece> pieces(3);
    pieces[0].elements = std::make_shared<SlotSet>(std::vector<Slot>{slots[2], slots[3], slots[4]});
    pieces[1].elements = std::make_shared<SlotSet>(std::vector<Slot>{slots[5], slots[6]});
    pieces[2].elements = std::make_shared<SlotSet>(std::vector<Slot>{slots[7]});
    body.rigid = numbered(std::move(pieces), body.elements);
    // One element of the first piece is held, too.
    holds.anchored = SlotSet(std::vector<Slot>{slots[2], slots[8], slots[9]});
    for (std::size_t c = 0; c < 3; ++c) {
      holds.at_most[c] = {{slots[10], body.q[c].at(slots[10]) + 3000}};
      holds.at_least[c] = {{slots[5], body.q[c].at(slots[5]) - 9000}};
    }
  }

  Vec3i voxel(std::size_t n) const { return voxel_of(body.elements, slots[n]); }
  static std::array<std::int32_t, 3> some(std::mt19937& random) {
    std::array<std::int32_t, 3> by;
    for (std::int32_t& each : by) each = std::int32_t(pick(random, -3 * kVoxel, 3 * kVoxel));
    return by;
  }
  Handle pose(std::mt19937& random, std::size_t piece) const {
    std::vector<Vec3i> voxels;
    body.rigid.list[piece].elements->for_each(
        [&](Slot slot) { voxels.push_back(voxel_of(body.elements, slot)); });
    return {Region::of_points(std::move(voxels), "piece"), some(random)};
  }

  /// Places of held elements in one coordinate, as far as they bound from that side.
  HeldPlaces places(const std::vector<Handle>& handles, std::size_t c, bool raises) const {
    HeldPlaces held;
    const auto now = [&](Slot slot) { return body.q[c].at(slot); };
    holds.anchored.for_each([&](Slot slot) { held[slot] = now(slot); });
    for (const Bound& bound : (raises ? holds.at_least : holds.at_most)[c]) {
      held[bound.slot] = bound.value;
    }
    held[slots[1]] = now(slots[1]);
    for (const Handle& handle : handles) {
      const SlotSet grabbed = elements_of(body, handle.region, "grab");
      grabbed.for_each([&](Slot slot) { held[slot] = now(slot) + handle.by_q[c]; });
    }
    return held;
  }

  Body body;
  std::vector<Slot> slots;
  Holds holds;
};

}  // namespace

TEST(PropertyPieceBounds, AreThoseOfAllThatIsHeldWhateverIsKnownFromPosesBefore) {
  std::mt19937 random(41);
  std::int64_t bounded = 0, free = 0;
  for (int n = 0; n < 24; ++n) {
    Block block = random_block(random, {13, 10, 11});
    block.table.links = n % 3 == 0 ? 26 : 6;
    if (n % 2) cut_randomly(random, block);
    if (body_of(block).elements.active_count() < 40) continue;
    HeldPieces held(random, block);
    const Handle given(held.voxel(0), HeldPieces::some(random));
    EcmSolver solver(held.body, n % 2 ? Engine::block : Engine::flat);
    LastingBounds lasting(1, n % 4 == 0 ? 2 * kVoxel : 0);
    for (const std::size_t wanted : {0, 1, 2, 1, 0}) {
      std::vector<Handle> handles = {given};
      for (std::size_t piece = 0; piece < 3; ++piece) {
        if (piece != wanted) handles.push_back(held.pose(random, piece));
      }
      const auto reach_q = std::int32_t(pick(random, 0.1 * kVoxel, 4 * kVoxel));
      const RigidPiece& piece = held.body.rigid.list[wanted];
      const auto found = solver.bounds_of({&piece}, handles, {Region(held.voxel(1))}, held.holds,
                                          reach_q, lasting);
      std::map<Slot, ElementBounds> of;
      for (const ElementBounds& bounds : found.front()) of.insert({bounds.slot, bounds});
      for (int c = 0; c < 3; ++c) {
        for (const bool raises : {true, false}) {
          const std::int64_t by = raises ? -reach_q : reach_q;
          const auto expected = envelope_of_held(held.body, c, raises, by,
                                                 held.places(handles, std::size_t(c), raises));
          piece.elements->for_each([&](Slot slot) {
            const std::int32_t none = raises ? -ElementBounds::kNone : ElementBounds::kNone;
            const bool is_free = expected[slot] == held.body.q[std::size_t(c)].at(slot) + by;
            const auto entry = of.find(slot);
            const std::int32_t is =
                entry == of.end()
                    ? none
                    : (raises ? entry->second.least : entry->second.most)[std::size_t(c)];
            ASSERT_EQ(is, is_free ? none : expected[slot]) << n << " " << wanted << " " << c;
            (is_free ? free : bounded) += 1;
          });
        }
      }
    }
  }
  EXPECT_GT(bounded, 300);
  EXPECT_GT(free, 100);
}
