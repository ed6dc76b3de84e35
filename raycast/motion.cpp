#include "raycast/motion.h"

#include <cmath>
#include <limits>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// Displacement; the nearest voxel's where corners of the cell are unknown; 0 far from the body.
Vec3d displacement_at(const Displacement* displacement, const Vec3d& pos_index) {
  if (displacement == nullptr) return Vec3d(0);
  Vec3d u(0);
  if (displacement->u.sample(pos_index, u)) return u;
  Vec3f nearest(0);
  displacement->u.at(floor_voxel(pos_index + Vec3d(0.5)), nearest);
  return Vec3d(nearest);
}

Vec3d place_seen(const FloatImage& picture, const CameraRays& rays, const Vec3d& forward,
                 std::size_t n) {
  const std::size_t row = n / std::size_t(picture.width);
  const std::size_t column = n % std::size_t(picture.width);
  const Ray ray = rays.at(double(column) + 0.5, double(row) + 0.5);
  return ray.origin_lps_mm +
         ray.direction_lps * (double(picture.depth_mm[n]) / ray.direction_lps.dot(forward));
}

}  // namespace

std::vector<Vec3d> rest_places(const FloatImage& picture, const Camera& camera,
                               const Geometry& geometry, const OffsetField* offsets) {
  const CameraRays rays(camera, picture.width, picture.height);
  const Vec3d forward = camera_frame(camera).forward;
  std::vector<Vec3d> places(picture.pixel_count(), Vec3d(std::numeric_limits<double>::quiet_NaN()));
  parallel_for(places.size(), [&](std::size_t n) {
    if (std::isnan(picture.depth_mm[n])) return;
    places[n] = geometry.index_from_world(place_seen(picture, rays, forward, n));
    Vec3d offset(0);
    if (offsets != nullptr && offsets->sample(places[n], offset)) places[n] += offset;
  });
  return places;
}

std::vector<float> screen_motion(const FloatImage& picture, const std::vector<Vec3d>& rest_places,
                                 const Geometry& geometry, const FilmedBody& now,
                                 const FilmedBody& then, const std::function<bool(int)>& moves) {
  const int width = picture.width, height = picture.height;
  const CameraRays rays(now.camera, width, height);
  const Vec3d forward = camera_frame(now.camera).forward;
  std::vector<float> motion(2 * picture.pixel_count());
  parallel_for(picture.pixel_count(), [&](std::size_t n) {
    if (std::isnan(picture.depth_mm[n])) return;
    Vec3d place = place_seen(picture, rays, forward, n);
    const int surface = picture.surface.empty() ? -1 : picture.surface[n];
    if (surface < 0 || !moves || moves(surface)) {
      // The difference of both keeps resting tissue at rest whatever the inversion's residual.
      const Vec3d step = displacement_at(then.displacement, rest_places[n]) -
                         displacement_at(now.displacement, rest_places[n]);
      place += geometry.world_vector_from_index(step);
    }
    double from_x = 0, from_y = 0, to_x = 0, to_y = 0;
    const Vec3d start = place_seen(picture, rays, forward, n);
    if (!project_to_pixel(now.camera, width, height, start, from_x, from_y)) return;
    if (!project_to_pixel(then.camera, width, height, place, to_x, to_y)) return;
    motion[2 * n] = float(to_x - from_x);
    motion[2 * n + 1] = float(from_y - to_y);
  });
  return motion;
}

}  // namespace supple
