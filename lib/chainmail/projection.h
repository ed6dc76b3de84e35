// One coordinate of the projection of project.cpp, for callers that keep offsets outside the body.
#pragma once

#include <optional>
#include <vector>

#include "lib/body/slot_set.h"
#include "lib/chainmail/free_pieces.h"
#include "lib/chainmail/propagate.h"
#include "lib/contact/contact_link.h"

namespace supple {

/// Bounds that keep an element from sinking below a value and from rising above one.
struct HeldBounds {
  std::vector<Seed> least, most;
};

/// The half-way values of the envelopes, within the bounds where the links allow that: they satisfy
/// every link. `values` meet the bounds, and `propagator` is that of the body. Each of the `pieces`
/// shifts as one. Throws Cancelled.
BrickValues projected(const BrickValues& values, int coordinate, const HeldBounds& bounds,
                      Propagator& propagator, Progress* progress = nullptr,
                      const FreePieces& pieces = {});

/// Bounds of elements that stay and of elements that are held, in the present state.
HeldBounds held_bounds(const Body& body, int coordinate, const SlotSet& anchored,
                       const Holds& held);

/// The projection of a body whose links all hold, but for contacts between elements. It visits the
/// bricks that contacts push and no others: all else has the values that it had.
class ContactProjection {
 public:
  /// All arguments outlive it. Elements that are `anchored` stay; rigid pieces have to be.
  ContactProjection(Body& body, const SlotSet& anchored, const Holds& held,
                    Progress* progress = nullptr, Engine engine = Engine::automatic);

  /// Moves one coordinate until the contacts hold, too. Returns the largest move in units of q;
  /// none, and nothing has moved, where holds, links and contacts contradict each other. Contacts
  /// of which one pushes for the ninth time do so. Throws Cancelled.
  std::optional<std::int64_t> meet(int coordinate, const std::vector<ContactLink>& contacts);
  /// The cost so far: bricks changed, summed over the turns of contacts; about 15 us each.
  std::int64_t changed_bricks() const { return m_changed_bricks; }

 private:
  bool reach(int c, const std::vector<ContactLink>& contacts, Direction direction);
  bool move(int c, const std::vector<ContactLink>& contacts, Direction direction,
            std::vector<Seed> seeds);
  template <class Visit>
  void for_each_held(int c, std::size_t brick, Direction direction, Visit&& visit) const;
  std::vector<Seed> beyond_bounds(int c, Direction direction) const;
  void average(int c, const std::vector<std::size_t>& bricks,
               const std::vector<std::int32_t>& above);
  std::int64_t commit(int c);

  Body& m_body;
  const SlotSet& m_anchored;
  Holds m_held;  // of the admissible offsets
  Progress* m_progress;
  Propagator m_propagator;
  UndoLog m_undo;
  std::int64_t m_changed_bricks = 0;
};

}  // namespace supple
