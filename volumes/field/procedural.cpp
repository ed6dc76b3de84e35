#include "volumes/field/procedural.h"

#include <cmath>

#include "volumes/base/parallel.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

/// A raised cosine: 1 at 0, 0 from `radius` on, with a continuous first derivative.
double raised_cosine(double distance, double radius) {
  return std::abs(distance) >= radius ? 0.0 : 0.5 * (1 + std::cos(kPi * distance / radius));
}

VectorBricks sample_function(const std::function<Vec3d(const Vec3d&)>& function,
                             const BrickTopology& where) {
  VectorBricks field{where, BrickVectors(where.brick_count())};
  field.vectors.touch_all();
  parallel_for(where.brick_count(), [&](std::size_t b) {
    Vec3f* const vectors = field.vectors.touch(b);
    for_each_active(where.mask(b), [&](int offset) {
      vectors[offset] = Vec3f(function(Vec3d(where.origin(b) + brick_local(offset))));
    });
  });
  return field;
}

}  // namespace

AnalyticWarp shear_warp(const Vec3d& center, double a) {
  return {[=](const Vec3d& p) { return Vec3d(a * (p.y - center.y), 0, 0); },
          [=](const Vec3d& p) { return Vec3d(-a * (p.y - center.y), 0, 0); }};
}

AnalyticWarp stretch_warp(const Vec3d& center, double factor) {
  return {[=](const Vec3d& p) { return Vec3d((factor - 1) * (p.x - center.x), 0, 0); },
          [=](const Vec3d& p) { return Vec3d((1 / factor - 1) * (p.x - center.x), 0, 0); }};
}

AnalyticWarp bump_warp(const Vec3d& center, double radius, double height) {
  const auto shift = [=](const Vec3d& p) {
    return height * raised_cosine(p.x - center.x, radius) * raised_cosine(p.z - center.z, radius);
  };
  return {[=](const Vec3d& p) { return Vec3d(0, shift(p), 0); },
          [=](const Vec3d& p) { return Vec3d(0, -shift(p), 0); }};
}

Displacement sample_displacement(const AnalyticWarp& warp, const Geometry& geometry,
                                 const BrickTopology& where) {
  return {geometry, sample_function(warp.displacement_voxels, where)};
}

OffsetField sample_offsets(const AnalyticWarp& warp, const Geometry& geometry,
                           const BrickTopology& where) {
  return {geometry, sample_function(warp.offset_voxels, where), {}};
}

}  // namespace supple
