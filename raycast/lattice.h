// A one-slice body drawn as its lattice of links over the grey image, as in the thesis' figures
// 4.9 to 4.13.
#pragma once

#include "raycast/camera.h"
#include "raycast/image.h"
#include "volumes/field/vector_bricks.h"
#include "volumes/grid/density_grid.h"

namespace supple {

struct LatticeStyle {
  int width = 800;
  int height = 800;
  bool grey_image = true;             // fill the deformed cells with the interpolated density
  bool links = true;                  // draw the links
  double grey_lo = 0, grey_hi = 255;  // densities that map to black and white
};

/// Draws the elements at X + u(X). The camera must see the slice from the front; the default for a
/// one-slice volume is orthographic, looking along +k, row 0 of the image at the top.
Image draw_lattice(const Geometry& geometry, const DensityGrid& density,
                   const Displacement& displacement, const Camera& camera,
                   const LatticeStyle& style);

/// Camera that shows the deformed slice as the image was read, with a margin of 5 %.
Camera lattice_camera(const Geometry& geometry, const Displacement& displacement, double aspect);

}  // namespace supple
