// A grid of tissue drawn on the surfaces of a picture in space: lines where the planes between
// cubes of tissue at rest come to the visible surface. They bend as the tissue does, on skin and on
// the faces of clips alike.
//
// Lines are found in the tangent plane of each pixel's place, from where the tissue there and a
// pixel beside it was at rest. Planes that lie nearly along the surface draw nothing on it: their
// lines would be blotches. Cost: three look-ups per pixel with a surface; all threads.
#pragma once

#include <array>
#include <functional>

#include "raycast/drawings/rest_place.h"
#include "raycast/pictures/image.h"
#include "raycast/scene/camera.h"
#include "volumes/base/fields.h"
#include "volumes/geometry/geometry.h"

namespace supple {

struct SurfaceGrid {
  double apart_mm = 10;  // between planes, along the grid axes
  double width = 1;      // of lines, pixels
  Rgb ink{0.35, 0.78, 1};
};

/// Returns true for a pixel that shows tissue and no mesh; null: all pixels do.
using ShowsTissue = std::function<bool(int x, int y)>;

/// Draws over the colours of a picture with depths and normals, where it shows a surface. Throws
/// InputError: a picture without them.
void draw_surface_grid(FloatImage& picture, const Camera& camera, const Geometry& geometry,
                       const SurfaceGrid& grid, const RestPlaceAt& rest_place,
                       const ShowsTissue& shows_tissue);

}  // namespace supple
