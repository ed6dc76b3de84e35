// A translucent volume under the microscope, such as the vitreous body: free sampling (thesis
// section 3.3.5) of a source that deforms and loses voxels while it is watched.
//
// Light of the lamp's cone and ambient light are scattered once towards the eye (emission and
// absorption); the haze casts no shadow in itself. Offsets follow the displacement locally: cells
// that changed are inverted again (volumes/field/inversion), and the nodes that they reach are
// packed anew. Densities are kept in 8 bits, offsets in 1/32 voxel up to 15.9 voxels; what came
// from farther is not drawn. Memory: 9 bytes per voxel of the box, and the inversion's. Cost of a
// draw: haze_lanes.h.
#pragma once

#include <memory>
#include <vector>

#include "raycast/microscope/microscope.h"
#include "volumes/field/offset_field.h"
#include "volumes/grid/density_grid.h"

namespace supple {

struct HazeLook {
  double extinction_per_mm = 0.35;  // of the largest density
  double largest_density = 255;
  std::array<double, 3> rgb{0.93, 0.96, 1.0};  // part of light that is scattered
  double ambient = 0.03;
  double lamp = 4.0;         // light of the lamp, beside its power
  double half_mm = 10;       // distance at which it has halved
  double step_voxels = 1.0;  // between samples, at most
};

class DeformedHaze final : public HazeLayer {
 public:
  explicit DeformedHaze(const HazeLook& look = {});
  ~DeformedHaze() override;

  /// Takes a body at rest. Throws InputError: a geometry whose axes are not perpendicular or not
  /// evenly spaced, fewer than two voxels along an axis, a look that is not positive.
  void set_body(const Geometry& geometry, const DensityGrid& density);
  /// Follows a displacement of the body, always of the same voxels; `changed` lists, each once, the
  /// bricks of its topology whose vectors may differ from those of the last call. Throws as
  /// IncrementalInversion.
  void update(const Displacement& displacement, const std::vector<std::int32_t>& changed);
  /// Voxels of the source that are void from now on.
  void remove(const std::vector<Vec3i>& voxels);
  void set_light(const LampLight& lamp);

  /// Linear, premultiplied. `depths` has the size of the picture; same bits for any number of
  /// threads.
  FloatImage draw(const Camera& camera, const RayDepths& depths) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace supple
