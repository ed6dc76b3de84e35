// One coordinate of the projection of project.cpp, for callers that keep offsets outside the body.
#pragma once

#include <optional>
#include <vector>

#include "lib/body/holds.h"
#include "lib/chainmail/contact_link.h"
#include "lib/chainmail/free_pieces.h"
#include "lib/chainmail/propagate.h"

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

/// The same with contacts beside the links. None where bounds, links and contacts contradict each
/// other: the bounds come first, and nothing is given up for them.
std::optional<BrickValues> projected(const BrickValues& values, int coordinate,
                                     const HeldBounds& bounds,
                                     const std::vector<ContactLink>& contacts,
                                     Propagator& propagator, Progress* progress = nullptr,
                                     const FreePieces& pieces = {});

/// Bounds of elements that stay and of elements that are held, in the present state.
HeldBounds held_bounds(const Body& body, int coordinate, const SlotSet& anchored,
                       const Holds& held);

/// The largest |q| by which two states of a coordinate differ.
std::int64_t largest_move(const BrickValues& before, const BrickValues& after);

}  // namespace supple
