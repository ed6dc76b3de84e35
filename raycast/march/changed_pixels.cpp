#include "raycast/march/changed_pixels.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

constexpr int kMarkedTile = 8;  // pixels
constexpr double kGuard = 1.5;  // voxels around a brick: a smooth derivative reads one beyond it
constexpr double kPixelGuard = 1;

struct SeenBox {
  double left, right, top, bottom;
  void add(double x, double y) {
    left = std::min(left, x);
    right = std::max(right, x);
    top = std::min(top, y);
    bottom = std::max(bottom, y);
  }
};

/// Tiles of a picture, each with the least distance along its rays at which they may meet a brick.
class NearestBricks {
 public:
  NearestBricks(const RenderContext& context, const Camera& camera)
      : m_geometry(context.geometry),
        m_camera(camera),
        m_forward(camera_frame(camera).forward),
        m_rays(camera, context.settings.width, context.settings.height),
        m_width(context.settings.width),
        m_height(context.settings.height),
        m_columns(tiles(m_width)),
        m_nearest(std::size_t(m_columns) * tiles(m_height), float(kEndless)) {}

  void add(const Vec3i& origin) {
    const Vec3d lo = Vec3d(origin) - Vec3d(kGuard);
    const Vec3d hi = Vec3d(origin) + Vec3d(kBrickDim + kGuard);
    const Vec3d middle = m_geometry.world_from_index((lo + hi) * 0.5);
    const Vec3d towards = middle - m_camera.position_lps_mm;
    const double distance =
        m_camera.projection == Projection::orthographic ? towards.dot(m_forward) : towards.length();
    double radius = 0;
    int in_front = 0;
    SeenBox seen{kEndless, -kEndless, kEndless, -kEndless};
    for (int n = 0; n < 8; ++n) {
      const Vec3d corner = m_geometry.world_from_index(
          {n & 1 ? hi.x : lo.x, n & 2 ? hi.y : lo.y, n & 4 ? hi.z : lo.z});
      radius = std::max(radius, (corner - middle).length());
      double x, y;
      if (!m_rays.pixel_of(corner, x, y)) continue;
      seen.add(x, y);
      ++in_front;
    }
    if (in_front == 0) return;
    if (in_front < 8) seen = {0, double(m_width), 0, double(m_height)};  // it may be seen anywhere
    mark(seen, std::nextafter(float(distance - radius), -float(kEndless)));
  }

  float nearest(int x, int y) const {
    return m_nearest[std::size_t(y / kMarkedTile) * m_columns + x / kMarkedTile];
  }

 private:
  static int tiles(int pixels) { return (pixels + kMarkedTile - 1) / kMarkedTile; }
  /// Index of the tile that holds this pixel; the first or last tile for a pixel off the picture.
  static int tile_of(double pixel, int pixels) {
    return int(std::clamp(pixel, 0.0, double(pixels - 1))) / kMarkedTile;
  }

  void mark(const SeenBox& seen, float distance) {
    const double left = seen.left - kPixelGuard, right = seen.right + kPixelGuard;
    const double top = seen.top - kPixelGuard, bottom = seen.bottom + kPixelGuard;
    if (right < 0 || bottom < 0 || left > m_width || top > m_height) return;
    for (int y = tile_of(top, m_height); y <= tile_of(bottom, m_height); ++y) {
      for (int x = tile_of(left, m_width); x <= tile_of(right, m_width); ++x) {
        float& nearest = m_nearest[std::size_t(y) * m_columns + x];
        nearest = std::min(nearest, distance);
      }
    }
  }

  const Geometry& m_geometry;
  const Camera& m_camera;
  Vec3d m_forward;
  CameraRays m_rays;
  int m_width, m_height;  // pixels
  int m_columns;          // tiles
  std::vector<float> m_nearest;
};

}  // namespace

std::vector<std::uint8_t> unchanged_pixels(const RenderContext& context, const Camera& camera,
                                           const std::vector<std::size_t>& bricks,
                                           const std::vector<float>& opaque_from_mm) {
  NearestBricks tiles(context, camera);
  for (const std::size_t b : bricks) tiles.add(context.output.index().origin(b));
  const int width = context.settings.width;
  std::vector<std::uint8_t> unchanged(opaque_from_mm.size());
  parallel_for(context.settings.height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t n = std::size_t(y) * width + x;
      unchanged[n] = opaque_from_mm[n] <= tiles.nearest(x, y);
    }
  });
  return unchanged;
}

}  // namespace supple
