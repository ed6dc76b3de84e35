// Functions that models of voxel bodies without time share.
#pragma once

#include <vector>

#include "lib/model/model.h"
#include "lib/relax/reaction.h"
#include "volumes/base/units.h"

namespace supple {

/// The elements of each handle, in their order. Throws InputError for one without element.
std::vector<SlotSet> elements_of_handles(const Body& body, const std::vector<Handle>& handles);

/// Reactions of the springs that relaxation knows, with the pressure of cells of these moduli
/// (lib/relax/reaction.h).
std::vector<Reaction> quasi_static_reactions(const HeldBody& held,
                                             const std::vector<SlotSet>& handles,
                                             const CellModuli& moduli);

}  // namespace supple
