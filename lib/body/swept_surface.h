// The surface that a curve leaves when it is swept along a direction: how an incision is drawn on
// the skin and cut to a depth.
#pragma once

#include <vector>

#include "volumes/io/mesh/triangle_mesh.h"

namespace supple {

struct SweptCurve {
  std::vector<Vec3d> points_lps_mm;  // at least two
  Vec3d direction{0, 0, 0};          // LPS, any length but 0
  double depth_mm = 0;               // how far along the direction
  double above_mm = 0;               // and how far against it, so that tissue above is cut too
  /// A spline through the points (Catmull and Rom, as 3D Slicer draws its curves) instead of
  /// straight segments.
  bool is_smooth = true;
};

/// Throws InputError for fewer than two different points, or a curve that runs along the direction
/// from end to end.
TriangleMesh swept_surface(const SweptCurve& curve);

}  // namespace supple
