#include "raycast/drawings/surface_grid.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// Share of a plane's coordinate in the change at rest along the surface: none to full ink.
constexpr double kAlongSurface = 0.15, kAcrossSurface = 0.4;
/// Surfaces that turn away keep this share of the ink.
constexpr double kTurnedAway = 0.5;
/// Rays that meet the surface at less than this cosine meet its tangent plane far away.
constexpr double kGrazing = 0.05;

class GridPainter {
 public:
  GridPainter(FloatImage& picture, const Camera& camera, const Geometry& geometry,
              const SurfaceGrid& grid, const RestPlaceAt& rest_place)
      : m_picture(picture),
        m_geometry(geometry),
        m_grid(grid),
        m_rest_place(rest_place),
        m_rays(camera, picture.width, picture.height),
        m_forward(camera_frame(camera).forward) {}

  void paint(int x, int y) const {
    const std::size_t n = std::size_t(y) * std::size_t(m_picture.width) + std::size_t(x);
    const float depth = m_picture.depth_mm[n];
    float* rgba = &m_picture.rgba[4 * n];
    if (std::isnan(depth) || rgba[3] == 0) return;
    const float* components = &m_picture.normal_lps[3 * n];
    const Vec3d normal(components[0], components[1], components[2]);
    const Ray ray = m_rays.at(x + 0.5, y + 0.5);
    const double facing = -ray.direction_lps.dot(normal);
    if (facing < kGrazing) return;
    const Vec3d place =
        ray.origin_lps_mm + ray.direction_lps * (depth / ray.direction_lps.dot(m_forward));
    Vec3d here, across, down;
    if (!at_rest(place, here) || !at_rest(beside(x + 1.5, y + 0.5, place, normal), across) ||
        !at_rest(beside(x + 0.5, y + 1.5, place, normal), down)) {
      return;
    }
    const double share = coverage(here, across - here, down - here);
    const double light = kTurnedAway + (1 - kTurnedAway) * facing;
    for (std::size_t c = 0; c < 3; ++c) {
      rgba[c] += float(share) * (float(m_grid.ink[c] * light) * rgba[3] - rgba[c]);
    }
  }

 private:
  /// Finds the place at rest along the grid axes, in mm.
  bool at_rest(const Vec3d& lps_mm, Vec3d& rest) const {
    if (!m_rest_place(m_geometry.index_from_world(lps_mm), rest)) return false;
    for (int a = 0; a < 3; ++a) rest[a] *= m_geometry.spacing_mm()[a];
    return true;
  }

  /// The point at which the ray of a pixel meets the tangent plane of a place.
  Vec3d beside(double px, double py, const Vec3d& place, const Vec3d& normal) const {
    const Ray ray = m_rays.at(px, py);
    const double rate = std::min(ray.direction_lps.dot(normal), -kGrazing / 2);
    return ray.origin_lps_mm + ray.direction_lps * ((place - ray.origin_lps_mm).dot(normal) / rate);
  }

  /// How much of a pixel the lines cover; `across` and `down`: the way at rest to the next pixels.
  double coverage(const Vec3d& rest, const Vec3d& across, const Vec3d& down) const {
    double most = 0;
    const double all = std::sqrt(across.length2() + down.length2());
    for (int a = 0; a < 3; ++a) {
      const double per_pixel = std::hypot(across[a], down[a]);  // mm
      if (!(per_pixel > 0) || per_pixel > m_grid.apart_mm / 2) continue;
      const double fade = std::clamp(
          (per_pixel / all - kAlongSurface) / (kAcrossSurface - kAlongSurface), 0.0, 1.0);
      const double off = std::abs(std::remainder(rest[a], m_grid.apart_mm)) / per_pixel;
      most = std::max(most, fade * std::clamp(0.5 * m_grid.width + 0.5 - off, 0.0, 1.0));
    }
    return most;
  }

  FloatImage& m_picture;
  const Geometry& m_geometry;
  const SurfaceGrid& m_grid;
  const RestPlaceAt& m_rest_place;
  CameraRays m_rays;
  Vec3d m_forward;
};

}  // namespace

void draw_surface_grid(FloatImage& picture, const Camera& camera, const Geometry& geometry,
                       const SurfaceGrid& grid, const RestPlaceAt& rest_place,
                       const ShowsTissue& shows_tissue) {
  if (!picture.has_auxiliary()) {
    throw InputError({"", "grid", "a picture without depths", "one with depths and normals"});
  }
  const GridPainter painter(picture, camera, geometry, grid, rest_place);
  parallel_for(picture.height, [&](int y) {
    for (int x = 0; x < picture.width; ++x) {
      if (!shows_tissue || shows_tissue(x, y)) painter.paint(x, y);
    }
  });
}

}  // namespace supple
