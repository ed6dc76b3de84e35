// The vitreous body at rest: a ball of voxels with densities, anchored at its outermost shell.
#pragma once

#include <cstdint>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"
#include "lib/operation/vitreous.h"

namespace supple {

struct VitreousAtRest {
  Body body;
  DensityGrid density;
  SlotSet shell;  // elements that lack a neighbour
};

/// Throws InputError as the constructor of Vitreous does.
VitreousAtRest make_vitreous(const VitreousSetup& setup, const Vec3d& centre_mm, std::uint64_t seed,
                             const std::vector<Obstacle>& outside);

}  // namespace supple
