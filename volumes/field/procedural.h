// Analytic displacements with analytic inverses: they generate test fields and judge the inverter.
// All in the index frame of `geometry`, unit voxel.
#pragma once

#include <functional>

#include "volumes/field/offset_field.h"
#include "volumes/geometry/geometry.h"

namespace supple {

/// u(X) and o(x) with x + o(x) + u(x + o(x)) = x.
struct AnalyticWarp {
  std::function<Vec3d(const Vec3d&)> displacement_voxels;
  std::function<Vec3d(const Vec3d&)> offset_voxels;
};

/// x += a * y (simple shear about `center`): exact inverse.
AnalyticWarp shear_warp(const Vec3d& center, double a);
/// Scales x by `factor` about `center`: exact inverse.
AnalyticWarp stretch_warp(const Vec3d& center, double factor);
/// Smooth bump: y += height * f(x) * f(z), f a raised cosine of `radius`; exact inverse because
/// the shift depends only on the coordinates that it leaves alone.
AnalyticWarp bump_warp(const Vec3d& center, double radius, double height);

/// u sampled at the active voxels of `where`.
Displacement sample_displacement(const AnalyticWarp& warp, const Geometry& geometry,
                                 const BrickTopology& where);
/// o sampled at the active voxels of `where`.
OffsetField sample_offsets(const AnalyticWarp& warp, const Geometry& geometry,
                           const BrickTopology& where);

}  // namespace supple
