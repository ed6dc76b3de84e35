// A small z-buffered canvas for triangles and lines, nine samples per pixel.
#pragma once

#include <array>
#include <vector>

#include "raycast/pictures/image.h"
#include "raycast/scene/camera.h"

namespace supple {

using Colour3 = std::array<float, 3>;  // 0…255

/// A projected point; `nearness` grows towards the viewer and is linear on the canvas.
struct CanvasPoint {
  double x = 0, y = 0;
  double nearness = 0;
  bool visible = false;
};

class Canvas {
 public:
  static constexpr int kSamples = 3;  // per pixel and axis

  Canvas(const Camera& camera, int width, int height, const Colour3& background);

  CanvasPoint project(const Vec3d& world_mm) const;
  /// Colours at the three corners, linear between them.
  void triangle(const std::array<CanvasPoint, 3>& p, const std::array<Colour3, 3>& colours);
  /// Draws a line that lies on top of surfaces which pass through its ends.
  void line(const CanvasPoint& a, const CanvasPoint& b, double width_pixels, const Colour3& colour);
  /// The canvas averaged to pixels.
  Image to_image() const;

 private:
  void plot(int x, int y, double nearness, const Colour3& colour);

  Camera m_camera;
  CameraFrame m_frame;
  int m_width, m_height;  // samples
  std::vector<float> m_nearness;
  std::vector<std::array<std::uint8_t, 3>> m_colours;
};

}  // namespace supple
