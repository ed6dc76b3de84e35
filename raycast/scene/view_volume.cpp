#include "raycast/scene/view_volume.h"

#include <algorithm>

namespace supple {

ViewVolume::ViewVolume(const Camera& camera, double aspect, const Geometry& geometry) {
  const CameraFrame frame = camera_frame(camera);
  const bool is_parallel = camera.projection == Projection::orthographic;
  const double half = is_parallel ? camera.height_mm / 2 : half_height_at_unit_distance(camera);
  const double left = (camera.window_shift - aspect) * half;
  const double right = (camera.window_shift + aspect) * half;
  // normal * p >= least for p relative to the camera, whose pyramid widens with the depth.
  const auto side = [&](const Vec3d& inwards, double least) {
    return is_parallel ? Plane{inwards, least} : Plane{inwards - frame.forward * least, 0};
  };
  m_planes =
      in_index_frame({Plane{frame.forward, 0}, side(frame.right, left), side(-frame.right, -right),
                      side(frame.up, -half), side(-frame.up, -half)},
                     camera.position_lps_mm, geometry);
}

ViewVolume::ViewVolume(const Geometry& slice, double thickness_mm, const Geometry& geometry) {
  const Vec3d normal = slice.direction()[2];
  m_planes = in_index_frame({Plane{normal, -thickness_mm / 2}, Plane{-normal, -thickness_mm / 2}},
                            slice.world_from_index(Vec3d(0)), geometry);
}

/// Takes planes in LPS, relative to a place, to the index frame.
std::vector<ViewVolume::Plane> ViewVolume::in_index_frame(std::vector<Plane> planes,
                                                          const Vec3d& from_lps_mm,
                                                          const Geometry& geometry) {
  const Vec3d origin = geometry.world_from_index(Vec3d(0)) - from_lps_mm;
  for (Plane& plane : planes) {
    plane.least -= plane.normal.dot(origin);
    Vec3d normal;
    for (int a = 0; a < 3; ++a) {
      Vec3d step(0);
      step[a] = 1;
      normal[a] = plane.normal.dot(geometry.world_vector_from_index(step));
    }
    plane.normal = normal;
  }
  return planes;
}

bool ViewVolume::meets(const Vec3d& lo, const Vec3d& hi) const {
  return std::all_of(m_planes.begin(), m_planes.end(), [&](const Plane& plane) {
    double most = 0;
    for (int a = 0; a < 3; ++a) most += plane.normal[a] * (plane.normal[a] > 0 ? hi[a] : lo[a]);
    return most >= plane.least;
  });
}

}  // namespace supple
