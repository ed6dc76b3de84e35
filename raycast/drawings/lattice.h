// A body drawn as its lattice of links over its grey cells, as in the thesis' figures 4.9 to 4.15:
// one-slice bodies flat or bent into space, volumes by the faces and links of their surface.
// Cost: about 1 µs per element and surface quad; a z-buffer of nine samples per pixel.
#pragma once

#include <array>
#include <vector>

#include "raycast/pictures/image.h"
#include "raycast/scene/camera.h"
#include "volumes/field/offset_field.h"
#include "volumes/geometry/geometry.h"
#include "volumes/grid/density_grid.h"

namespace supple {

// A small z-buffered canvas for triangles and lines, nine samples per pixel.

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

struct LatticeStyle {
  int width = 800;
  int height = 800;
  bool grey_image = true;             // fill the deformed cells with the interpolated density
  bool links = true;                  // draw the links
  double link_width_pixels = 1;       // 0.34 … 10
  double grey_lo = 0, grey_hi = 255;  // densities that map to black and white

  /// Throws InputError: sizes < 1 or > 16384, link width out of range, grey_lo not below grey_hi.
  void validate() const;
};

/// Draws the voxels where `displacement` is valid at X + u(X), on white, opaque. The camera decides
/// whether a slice is seen flat or in space. Cell faces are darkened as they turn away from the
/// viewer; a slice seen from the front keeps its greys.
Image draw_lattice(const Geometry& geometry, const DensityGrid& density,
                   const Displacement& displacement, const Camera& camera,
                   const LatticeStyle& style);

/// Orthographic camera that shows the deformed slice as the image was read (i to the right, j
/// down), with a margin of 5 % on each side.
Camera lattice_camera(const Geometry& geometry, const Displacement& displacement, double aspect);

}  // namespace supple
