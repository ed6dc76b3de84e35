// The force on a handle that holds a deformed body, from the energy of relaxation (relaxation.h).
//
// Per grid coordinate, a handle feels the springs of its own elements and what links at their
// limits transmit: elements that such links join to it lean on it, so the forces of their springs
// count as well. A breadth-first flood from everything that is held, over links at either limit,
// gives each element that it reaches to the holder that is fewest links away. The sum of their
// forces is
// - where relaxation has come to its minimum, the force that keeps the handle in place, that is
//   -d(least energy)/d(handle): without the links at their limits, those elements would not be
//   balanced, and by the Karush-Kuhn-Tucker conditions the links carry just what they lack;
// - after an ECM drag alone, -d(energy)/d(handle) for a drag that goes on: what is at its limit
//   comes along, the rest stays.
//
// A link at its longest can pull but not push. At the minimum that need not be looked at: the sign
// follows from the balance, and a flood in the direction of pulling alone would lose forces, since
// a link may transmit what another one, the other way round, keeps from slipping. Away from it, in
// a body that was dragged to and fro, elements count that would lag behind a handle that comes
// nearer: there it is the force on a handle that takes along, either way, what is at its limit.
#pragma once

#include <array>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"
#include "lib/chainmail/ecm.h"

namespace supple {

struct Reaction {
  /// With which the body pulls at the holder, in N, LPS. Its work on a way dx is force . dx, also
  /// where the grid's axes are not perpendicular.
  Vec3d force_n{0, 0, 0};
  /// Per grid coordinate: links at their limits join this holder to another one. They can carry any
  /// force between the two, which statics does not determine: the force is then a part only.
  std::array<bool, 3> taut{false, false, false};
};

/// One per handle. As for relaxation, elements of `fixed` and `held.still` are held, and those of
/// push handles in the coordinates where they lie at their bound; what nobody holds there leans on
/// others. An element of several handles counts for the first, what is held without belonging to
/// one is another holder. Cells count with that bulk modulus, as in relaxation with it; 0: not.
/// In a coordinate in which nothing moved or rests elsewhere there is no force, and nothing is
/// taut. Throws InputError: a bulk modulus out of range.
///
/// O(elements held by the handles or leaning on them), all those that are held where a handle is
/// taut to one; 2 kB per brick with any of these.
std::vector<Reaction> reactions(const Body& body, const std::vector<SlotSet>& handles,
                                const SlotSet& fixed, const Holds& held,
                                double volume_stiffness_kpa = 0);

}  // namespace supple
