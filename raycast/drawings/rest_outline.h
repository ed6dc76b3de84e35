// The silhouette of the body at rest over a picture in space, so that one sees how far it has gone.
//
// Elements on the surface are balls that hold their voxels; what no ball covers lies outside. Cost:
// 12 bytes per element on the surface.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "raycast/pictures/image.h"
#include "raycast/scene/camera.h"
#include "volumes/grid/brick_topology.h"

namespace supple {

class RestOutline {
 public:
  RestOutline(const BrickTopology& elements, const Geometry& geometry);

  /// 1 in pixels that the body at rest covers, 0 elsewhere, row by row. Nothing behind the camera
  /// counts.
  std::vector<std::uint8_t> mask(const Camera& camera, int width, int height) const;
  /// Colours the pixels at the rim of the mask, inside of it, opaque.
  void draw(FloatImage& picture, const Camera& camera) const;

 private:
  std::vector<Vec3f> m_places;  // of elements with a free face, LPS, mm
  double m_radius_mm;
};

}  // namespace supple
