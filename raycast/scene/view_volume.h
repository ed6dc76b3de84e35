// The part of the lattice that a picture shows: work for the picture alone ends at its edges.
#pragma once

#include <vector>

#include "raycast/scene/camera.h"

namespace supple {

class ViewVolume {
 public:
  /// The pyramid, or of an orthographic camera the box, of all rays of a picture. `aspect`: width
  /// over height of the picture.
  ViewVolume(const Camera& camera, double aspect, const Geometry& geometry);
  /// The slab within half of a thickness of the plane of a slice's grid, on both sides.
  ViewVolume(const Geometry& slice, double thickness_mm, const Geometry& geometry);

  /// True if a box of the index frame may be seen: for all boxes that a ray passes through, and for
  /// some near the edges of the pyramid.
  bool meets(const Vec3d& lo, const Vec3d& hi) const;

 private:
  /// Places p that are seen have normal * p >= least.
  struct Plane {
    Vec3d normal;
    double least;
  };
  static std::vector<Plane> in_index_frame(std::vector<Plane> planes, const Vec3d& from_lps_mm,
                                           const Geometry& geometry);

  std::vector<Plane> m_planes;  // of the index frame
};

}  // namespace supple
