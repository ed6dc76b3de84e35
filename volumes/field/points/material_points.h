// Points that go along with the material: X is now at X + u(X).
// Cost: that of a SmoothExtension of u, and about 1 µs per point.
#pragma once

#include <vector>

#include "volumes/field/offset_field.h"

namespace supple {

/// Places now of points given at rest, LPS mm. Outside the material u carries on smoothly, as in
/// `void extend`, so that objects which reach beyond the tissue are not torn at its surface.
std::vector<Vec3d> moved_along(const Displacement& displacement,
                               const std::vector<Vec3d>& points_lps_mm);

}  // namespace supple
