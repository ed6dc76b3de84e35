#include "raycast/drawings/rest_outline.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

/// Yellow, as in slices.
constexpr float kOutline[3] = {1, 200 / 255.0f, 0};
/// A ball of this part of a voxel's diagonal holds it whole, so that there are no holes.
constexpr double kBallPart = 0.5;

bool has_free_face(const BrickTopology& elements, const Vec3i& voxel) {
  for (int a = 0; a < 3; ++a) {
    for (const int step : {-1, 1}) {
      Vec3i beside = voxel;
      beside[a] += step;
      if (!elements.is_active(beside)) return true;
    }
  }
  return false;
}

}  // namespace

RestOutline::RestOutline(const BrickTopology& elements, const Geometry& geometry) {
  const Vec3d spacing = geometry.spacing_mm();
  m_radius_mm = kBallPart * spacing.length();
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for_each_active(elements.mask(b), [&](int offset) {
      const Vec3i voxel = elements.origin(b) + brick_local(offset);
      if (!has_free_face(elements, voxel)) return;
      m_places.emplace_back(geometry.world_from_index(Vec3d(voxel)));
    });
  }
}

std::vector<std::uint8_t> RestOutline::mask(const Camera& camera, int width, int height) const {
  std::vector<std::uint8_t> mask(std::size_t(width) * std::size_t(height), 0);
  const CameraFrame frame = camera_frame(camera);
  const bool is_orthographic = camera.projection == Projection::orthographic;
  const double unit_half = half_height_at_unit_distance(camera);
  for (const Vec3f& place : m_places) {
    const Vec3d from_camera = Vec3d(place) - camera.position_lps_mm;
    const double depth = from_camera.dot(frame.forward);
    if (!(depth > m_radius_mm)) continue;
    const double per_mm =
        height / (2 * (is_orthographic ? camera.height_mm / 2 : depth * unit_half));
    const double x =
        from_camera.dot(frame.right) * per_mm + (width - camera.window_shift * height) / 2;
    const double y = height / 2.0 - from_camera.dot(frame.up) * per_mm;
    const double radius = std::max(m_radius_mm * per_mm, 0.75);
    const int top = std::max(0, int(std::ceil(y - radius - 0.5)));
    const int bottom = std::min(height - 1, int(std::floor(y + radius - 0.5)));
    for (int row = top; row <= bottom; ++row) {
      const double down = row + 0.5 - y;
      const double half = std::sqrt(std::max(radius * radius - down * down, 0.0));
      const int left = std::max(0, int(std::ceil(x - half - 0.5)));
      const int right = std::min(width - 1, int(std::floor(x + half - 0.5)));
      if (left > right) continue;
      std::fill_n(&mask[std::size_t(row) * std::size_t(width) + std::size_t(left)],
                  right - left + 1, std::uint8_t(1));
    }
  }
  return mask;
}

void RestOutline::draw(FloatImage& picture, const Camera& camera) const {
  const int width = picture.width, height = picture.height;
  const std::vector<std::uint8_t> covered = mask(camera, width, height);
  const auto is_free = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < width && y < height &&
           covered[std::size_t(y) * std::size_t(width) + std::size_t(x)] == 0;
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (is_free(x, y)) continue;
      if (!is_free(x - 1, y) && !is_free(x + 1, y) && !is_free(x, y - 1) && !is_free(x, y + 1)) {
        continue;
      }
      float* rgba = &picture.rgba[4 * (std::size_t(y) * std::size_t(width) + std::size_t(x))];
      std::copy_n(kOutline, 3, rgba);
      rgba[3] = 1;
    }
  }
}

}  // namespace supple
