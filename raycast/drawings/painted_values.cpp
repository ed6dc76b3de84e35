#include "raycast/drawings/painted_values.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

constexpr double kPaintShare = 0.55;  // of the colour, over what is seen
constexpr double kFadingPart = 0.1;   // of the range, beside the value that is clear
constexpr double kHalfStep = 0.5;     // voxels, of a difference
constexpr double kFlat = 1e-6;        // a gradient of less is none

std::optional<GridGradient> inverse_of(const GridGradient& g) {
  const double volume = determinant(g);
  if (std::abs(volume) < kFlat) return std::nullopt;
  const Vec3d rows[3] = {g[1].cross(g[2]) / volume, g[2].cross(g[0]) / volume,
                         g[0].cross(g[1]) / volume};
  GridGradient inverse;
  for (int c = 0; c < 3; ++c) {
    inverse[std::size_t(c)] = {rows[0][c], rows[1][c], rows[2][c]};
  }
  return inverse;
}

}  // namespace

Rgb value_colour(ValueColours colours, double share) {
  if (colours == ValueColours::ascending) return offset_colour(share);
  const double towards = std::abs(2 * share - 1);
  const Rgb end = share < 0.5 ? Rgb{0.13, 0.4, 0.85} : Rgb{0.84, 0.19, 0.15};
  Rgb colour;
  for (std::size_t c = 0; c < 3; ++c) colour[c] = 0.87 + (end[c] - 0.87) * towards;
  return colour;
}

Rgb ValuePaint::colour(double of) const {
  return value_colour(colours, std::clamp((of - range.lo) / (range.hi - range.lo), 0., 1.));
}

double ValuePaint::share(double of) const {
  if (!clear) return kPaintShare;
  return kPaintShare * std::min(1., std::abs(of - *clear) / (kFadingPart * (range.hi - range.lo)));
}

void paint_values(Image& slice, const Geometry& grid, const ValuePaint& paint,
                  const Geometry& geometry) {
  parallel_for(slice.height, [&](int y) {
    for (int x = 0; x < slice.width; ++x) {
      std::uint8_t* pixel = &slice.rgba[4 * (std::size_t(y) * slice.width + x)];
      if (pixel[3] == 0) continue;
      const auto value =
          paint.value(geometry.index_from_world(grid.world_from_index(Vec3d(x, y, 0))));
      if (!value) continue;
      const Rgb colour = paint.colour(*value);
      const double share = paint.share(*value);
      for (std::size_t c = 0; c < 3; ++c) {
        pixel[c] = std::uint8_t(std::lround((1 - share) * pixel[c] + share * 255 * colour[c]));
      }
    }
  });
}

void paint_values(FloatImage& picture, const Camera& camera, const ValuePaint& paint,
                  const Geometry& geometry) {
  const Vec3d forward = camera_frame(camera).forward;
  parallel_for(picture.height, [&](int y) {
    for (int x = 0; x < picture.width; ++x) {
      const std::size_t n = std::size_t(y) * picture.width + x;
      const double depth = picture.depth_mm[n];
      const bool is_surface = !picture.surface.empty() && picture.surface[n] >= 0;
      if (!std::isfinite(depth) || is_surface) continue;
      const Ray ray = camera_ray(camera, picture.width, picture.height, x + 0.5, y + 0.5);
      const Vec3d place =
          ray.origin_lps_mm + ray.direction_lps * (depth / ray.direction_lps.dot(forward));
      const auto value = paint.value(geometry.index_from_world(place));
      if (!value) continue;
      const Rgb colour = paint.colour(*value);
      const double share = paint.share(*value);
      float* pixel = &picture.rgba[4 * n];
      const double light = std::max({pixel[0], pixel[1], pixel[2]});
      for (std::size_t c = 0; c < 3; ++c) {
        pixel[c] = float((1 - share) * pixel[c] + share * light * colour[c]);
      }
    }
  });
}

double determinant(const GridGradient& gradient) {
  return gradient[0].dot(gradient[1].cross(gradient[2]));
}

std::optional<GridGradient> gradient_at(
    const Vec3d& index, const std::function<bool(const Vec3d& index, Vec3d& place)>& at) {
  GridGradient g;
  for (int a = 0; a < 3; ++a) {
    Vec3d step(0), ahead, behind;
    step[a] = kHalfStep;
    if (!at(index + step, ahead) || !at(index - step, behind)) return std::nullopt;
    g[std::size_t(a)] = (ahead - behind) / (2 * kHalfStep);
  }
  return g;
}

std::optional<GridGradient> deformation_at(const RestPlaceAt& rest, const Vec3d& index) {
  const auto gradient = gradient_at(index, rest);
  return gradient ? inverse_of(*gradient) : std::nullopt;
}

}  // namespace supple
