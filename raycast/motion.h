// Channels for compositing programs: the motion of every visible place on the screen between two
// pictures, and numbers of tissues and meshes.
#pragma once

#include <functional>
#include <vector>

#include "raycast/pictures/image.h"
#include "raycast/scene/camera.h"
#include "volumes/field/offset_field.h"

namespace supple {

/// A body under a camera.
struct FilmedBody {
  Camera camera;
  const Displacement* displacement;  // null: at rest
};

/// Places at rest of the tissue seen in the pixels, in voxels. NaN where nothing is seen, see
/// FloatImage. `offsets`: those that the picture was drawn with; null: at rest.
std::vector<Vec3d> rest_places(const FloatImage& picture, const Camera& camera,
                               const Geometry& geometry, const OffsetField* offsets);

/// Motion of the visible place of each pixel from `now` to `then`, in pixels to the right and
/// upwards, two numbers for each: with the tissue, or where `moves` says no of a surface (its
/// index) with the camera alone. 0 where nothing is seen and for places that go behind the camera.
/// Exact for the place that the depth names. Within a voxel of a cut the motions of both sides are
/// mixed.
std::vector<float> screen_motion(const FloatImage& picture, const std::vector<Vec3d>& rest_places,
                                 const Geometry& geometry, const FilmedBody& now,
                                 const FilmedBody& then,
                                 const std::function<bool(int)>& moves = {});

}  // namespace supple
