// The handles of a model of a voxel body, found in it.
#pragma once

#include <vector>

#include "lib/body/slot_set.h"
#include "lib/model/held_body.h"
#include "lib/model/model.h"

namespace supple {

constexpr double kJoulePerMicrojoule = 1e-6;

/// In the order of the handles. Throws InputError for one without element.
std::vector<SlotSet> elements_of_handles(const Body& body, const std::vector<Handle>& handles);

/// Quasi-static ones (lib/relax/reaction.h), with the pressure of cells of that bulk modulus.
std::vector<Reaction> reactions_of(const HeldBody& held, const std::vector<SlotSet>& handles,
                                   double volume_stiffness_kpa = 0);

}  // namespace supple
