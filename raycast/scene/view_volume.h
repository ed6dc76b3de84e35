// What a camera can see of the lattice: work that a picture needs there alone ends at its edges.
#pragma once

#include <array>

#include "raycast/scene/camera.h"

namespace supple {

/// The pyramid, or of an orthographic camera the box, of all rays of a picture.
class ViewVolume {
 public:
  /// `aspect`: width over height of the picture.
  ViewVolume(const Camera& camera, double aspect, const Geometry& geometry);

  /// Whether a ray may pass through a box of the index frame. True for all boxes that one passes
  /// through, and for some near the edges of the pyramid.
  bool meets(const Vec3d& lo, const Vec3d& hi) const;

 private:
  /// Of the index frame: what is seen has normal * p >= least.
  struct Plane {
    Vec3d normal;
    double least;
  };

  std::array<Plane, 5> m_planes;  // before the camera, and its four sides
};

}  // namespace supple
