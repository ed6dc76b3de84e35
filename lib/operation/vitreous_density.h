// Densities of a vitreous body, so that it can be seen: a thin gel with fibrils and opacities that
// are denser near its base (towards +z, at the wall). Generated; no anatomy.
#pragma once

#include <cstdint>

#include "volumes/grid/density_grid.h"

namespace supple {

/// Densities, 0 … 255, of a ball of voxels about `centre`, in voxels; the same for the same seed on
/// all machines. Cost: 1 µs per element.
DensityGrid make_vitreous_density(const BrickTopology& elements, const Vec3d& centre,
                                  double radius_voxels, std::uint64_t seed);

}  // namespace supple
