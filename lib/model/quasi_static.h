// What models of voxel bodies without time share.
#pragma once

#include <vector>

#include "lib/model/held_body.h"
#include "lib/relax/reaction.h"

namespace supple {

constexpr double kJoulePerMicrojoule = 1e-6;

/// Of the springs that relaxation knows, with the pressure of cells of that bulk modulus in kPa
/// (lib/relax/reaction.h). Throws InputError for a handle without element.
std::vector<Reaction> quasi_static_reactions(const HeldBody& held,
                                             const std::vector<Handle>& handles,
                                             double volume_stiffness_kpa);

}  // namespace supple
