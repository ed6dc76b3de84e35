// The force on a handle that holds a deformed body, from the energy of relaxation (relaxation.h).
//
// Per grid coordinate, a handle feels the springs of its own elements and the forces that links at
// their limits transmit: elements that such links join to it lean on it, so the forces of their
// springs count as well. A breadth-first flood from everything that is held, over links at either
// limit, gives each element that it reaches to the holder that is fewest links away. The sum of
// their forces is
// - where relaxation has come to its minimum, the force that keeps the handle in place, that is
//   -d(least energy)/d(handle): without the links at their limits, those elements would not be
//   balanced, and by the Karush-Kuhn-Tucker conditions the links carry the missing force;
// - after an ECM drag, -d(energy)/d(handle) for a drag that goes on: links at their limits come
//   along, the rest stays.
//
// A link at its longest pulls and does not push, yet the flood asks for no direction. At the
// minimum the sign follows from the balance. After a drag it need not be asked: where an element
// would come along and its neighbour would not, the last bit of that drag moved one and left the
// other, so their link has just left its limit, if it was at one. Only for a handle that did not
// move last, in a body that was not relaxed since, elements count that would not follow it.
#pragma once

#include <array>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/region.h"
#include "lib/body/slot_set.h"
#include "lib/relax/cell_moduli.h"
#include "lib/relax/relax_report.h"

namespace supple {

/// The reactions, one per handle. As for relaxation, elements of `fixed` and `held.anchored` are
/// held, and those of push handles in the coordinates where they lie at their bound; elements that
/// nobody holds there lean on others. An element of several handles counts for the first. Held
/// elements of no handle are one more holder. Cells count with these bulk moduli, as in relaxation
/// with them. In a coordinate in which nothing moved or rests elsewhere (with cells: in any of the
/// three) there is no force, and nothing is taut. Throws InputError: a bulk modulus out of range.
///
/// O(elements held by the handles or leaning on them), all those that are held where a handle is
/// taut to one; 2 kB per brick with any of these.
std::vector<Reaction> reactions(const Body& body, const std::vector<SlotSet>& handles,
                                const SlotSet& fixed, const Holds& held,
                                const CellModuli& moduli = {});

}  // namespace supple
