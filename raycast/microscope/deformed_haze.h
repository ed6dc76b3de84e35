// A translucent volume under the microscope, such as the vitreous body: free sampling (thesis
// section 3.3.5) of a source that deforms and loses voxels while it is watched.
//
// Light of the lamp's cone and ambient light are scattered once towards the eye (emission and
// absorption); the haze casts no shadow in itself. Offsets follow the elements locally: where some
// went on or are gone, the nodes that they reach are solved by fixed-point iteration, without the
// certificate of an inversion (volumes/field/inversion), which a haze does not need. Densities are
// kept in 8 bits, ways and offsets in 1/32 voxel up to 15.9 voxels. Memory: 13 bytes per voxel of
// the box.
//
// Where pixels are small against voxels, only rays up to half a voxel apart are marched, and pixels
// between them are interpolated if all end at like depths. Cost per marched sample: haze_lanes.h.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "raycast/microscope/microscope.h"
#include "volumes/grid/density_grid.h"

namespace supple {

struct HazeLook {
  double extinction_per_mm = 0.35;  // of the largest density
  double largest_density = 255;
  std::array<double, 3> rgb{0.93, 0.96, 1.0};  // part of light that is scattered
  double ambient = 0.03;
  double lamp = 4.0;         // light of the lamp, beside its power
  double half_mm = 10;       // distance at which it has halved
  double step_voxels = 1.5;  // between samples, at most
};

/// The elements of a brick of the source: which of them are left, and the ways that they went from
/// rest, 512 along each axis in 2^-16 voxel.
struct HazeElements {
  Vec3i origin;
  BrickMask left;
  std::array<const std::int32_t*, 3> ways;
};

class DeformedHaze final : public HazeLayer {
 public:
  explicit DeformedHaze(const HazeLook& look = {});
  ~DeformedHaze() override;

  /// Takes a body at rest. Throws InputError: a geometry whose axes are not perpendicular or not
  /// evenly spaced, fewer than two voxels along an axis, a look that is not positive.
  void set_body(const Geometry& geometry, const DensityGrid& density);
  /// Follows the elements of bricks, each of them once, at least of those that changed since the
  /// last call. What is gone does not come back. Needs ways whose gradient is below 1 as links keep
  /// it; elements that no longer hang together may pass through each other.
  void update(const std::vector<HazeElements>& bricks);
  void set_light(const LampLight& lamp);

  /// Linear, premultiplied. `depths` has the size of the picture; same bits for any number of
  /// threads.
  FloatImage draw(const Camera& camera, const RayDepths& depths) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace supple
