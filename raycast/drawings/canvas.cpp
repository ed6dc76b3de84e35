#include "raycast/drawings/canvas.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple {

namespace {

double edge(const CanvasPoint& a, const CanvasPoint& b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

/// Samples whose centres lie in lo … hi, clipped to 0 … count - 1.
struct PixelRange {
  int first, last;
};
PixelRange covered(double lo, double hi, int count) {
  const double first = std::clamp(std::ceil(lo - 0.5), 0.0, double(count));
  const double last = std::clamp(std::floor(hi - 0.5), -1.0, double(count - 1));
  return {int(first), int(last)};
}

}  // namespace

Canvas::Canvas(const Camera& camera, int width, int height, const Colour3& background)
    : m_camera(camera),
      m_frame(camera_frame(camera)),
      m_width(width * kSamples),
      m_height(height * kSamples) {
  const std::size_t count = std::size_t(m_width) * m_height;
  m_nearness.assign(count, -std::numeric_limits<float>::infinity());
  m_colours.assign(count, {std::uint8_t(background[0]), std::uint8_t(background[1]),
                           std::uint8_t(background[2])});
}

CanvasPoint Canvas::project(const Vec3d& world_mm) const {
  CanvasPoint p;
  p.visible = project_to_pixel(m_camera, m_width, m_height, world_mm, p.x, p.y);
  const double depth = (world_mm - m_camera.position_lps_mm).dot(m_frame.forward);
  // 1 / depth is what perspective keeps linear on the picture.
  p.nearness = m_camera.projection == Projection::perspective ? 1 / depth : -depth;
  return p;
}

void Canvas::plot(int x, int y, double nearness, const Colour3& colour) {
  const std::size_t n = std::size_t(y) * m_width + x;
  if (float(nearness) < m_nearness[n]) return;
  m_nearness[n] = float(nearness);
  for (int c = 0; c < 3; ++c) {
    m_colours[n][c] = std::uint8_t(std::lround(std::clamp(colour[c], 0.0f, 255.0f)));
  }
}

void Canvas::triangle(const std::array<CanvasPoint, 3>& p, const std::array<Colour3, 3>& colours) {
  const double area = edge(p[0], p[1], p[2].x, p[2].y);
  if (!p[0].visible || !p[1].visible || !p[2].visible || area == 0) return;
  const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
  const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
  const PixelRange xs = covered(left, right, m_width), ys = covered(top, bottom, m_height);
  for (int y = ys.first; y <= ys.last; ++y) {
    for (int x = xs.first; x <= xs.last; ++x) {
      const double a = edge(p[1], p[2], x + 0.5, y + 0.5) / area;
      const double b = edge(p[2], p[0], x + 0.5, y + 0.5) / area;
      const double c = 1 - a - b;
      if (a < 0 || b < 0 || c < 0) continue;
      Colour3 colour;
      for (int n = 0; n < 3; ++n) {
        colour[n] = float(a * colours[0][n] + b * colours[1][n] + c * colours[2][n]);
      }
      plot(x, y, a * p[0].nearness + b * p[1].nearness + c * p[2].nearness, colour);
    }
  }
}

void Canvas::line(const CanvasPoint& a, const CanvasPoint& b, double width_pixels,
                  const Colour3& colour) {
  if (!a.visible || !b.visible) return;
  const double radius = 0.5 * width_pixels * kSamples;
  const double dx = b.x - a.x, dy = b.y - a.y, squared = dx * dx + dy * dy;
  // A bias of the depth that the surface may gain across the line's width.
  const double bias = 2e-4 * std::abs(a.nearness) + 0.5 * std::abs(b.nearness - a.nearness);
  const PixelRange xs = covered(std::min(a.x, b.x) - radius, std::max(a.x, b.x) + radius, m_width);
  const PixelRange ys = covered(std::min(a.y, b.y) - radius, std::max(a.y, b.y) + radius, m_height);
  for (int y = ys.first; y <= ys.last; ++y) {
    for (int x = xs.first; x <= xs.last; ++x) {
      const double px = x + 0.5 - a.x, py = y + 0.5 - a.y;
      const double t = squared > 0 ? std::clamp((px * dx + py * dy) / squared, 0.0, 1.0) : 0.0;
      if (std::hypot(px - t * dx, py - t * dy) > radius) continue;
      plot(x, y, a.nearness + t * (b.nearness - a.nearness) + bias, colour);
    }
  }
}

Image Canvas::to_image() const {
  Image image(m_width / kSamples, m_height / kSamples);
  image.has_alpha = false;
  constexpr int kPerPixel = kSamples * kSamples;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      std::uint8_t* out = &image.rgba[4 * (std::size_t(y) * image.width + x)];
      for (int c = 0; c < 3; ++c) {
        int sum = 0;
        for (int s = 0; s < kPerPixel; ++s) {
          const int row = y * kSamples + s / kSamples, column = x * kSamples + s % kSamples;
          sum += m_colours[std::size_t(row) * m_width + column][c];
        }
        out[c] = std::uint8_t((sum + kPerPixel / 2) / kPerPixel);
      }
      out[3] = 255;
    }
  }
  return image;
}

}  // namespace supple
