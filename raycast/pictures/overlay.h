// Shapes and words drawn over a picture. Their places are decided by raycast/drawings; here they
// become pixels. OpenCV draws them, in the plugin that is loaded when the first is drawn.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "raycast/pictures/image.h"
#include "volumes/base/fields.h"

namespace supple {

/// Pixel coordinates as of cameras: to the right and down, centres at +0.5.
using PixelPoint = std::array<double, 2>;

/// A filled convex polygon.
struct OverlayFace {
  std::vector<PixelPoint> corners;
  Rgb fill{1, 1, 1};
};

/// A line through its points; a halo is a rim that keeps it legible on any ground.
struct OverlayLine {
  std::vector<PixelPoint> points;
  double width = 1;  // pixels
  Rgb ink{1, 1, 1};
  std::optional<Rgb> halo;
};

/// One line of ASCII.
struct OverlayText {
  std::string text;
  PixelPoint at{};        // where the text is held
  PixelPoint hold{0, 0};  // part of its width and height that lies there: 0 left and top, 1 right
                          // and bottom
  double height = 12;     // of capitals, pixels
  Rgb ink{1, 1, 1};
  std::optional<Rgb> halo;
  /// Pixels per pixel of plain text, along its line and down: other values slant it.
  PixelPoint along{1, 0}, down{0, 1};
};

using OverlayShape = std::variant<OverlayFace, OverlayLine, OverlayText>;
/// Shapes in the order of drawing.
using Overlay = std::vector<OverlayShape>;

/// Draws over the picture with smooth edges; transparent pixels become opaque there. Parts beyond
/// the picture are cut off. Depths and the like stay.
void draw_overlay(FloatImage& picture, const Overlay& overlay);

}  // namespace supple
