// Pictures of what was seen beside the colours: depth, normal, offset length.
//
// Offsets are shown in the colours of magma from light to dark (uniform in perceived lightness), so
// that what stayed is light and keeps its relief; depths in greys, near is bright. The legend
// stands in a strip to the right of the picture.
#pragma once

#include <array>

#include "raycast/pictures/float_image.h"

namespace supple {

/// Values that the ends of the map stand for.
struct ScalarRange {
  double lo = 0, hi = 1;
};
/// Of the values that are there; 0…1 without any.
ScalarRange range_of(const std::vector<float>& values);

/// Ticks at multiples of 1, 2 or 5 times a power of ten, four to eight of them.
std::vector<double> legend_ticks(const ScalarRange& range);

/// Pictures that are lower than this get no legend: it would not be legible.
constexpr int kLowestWithLegend = 160;

/// Offset lengths in colours, lit from the camera so that the surface can be seen, opaque on white,
/// with a legend in mm. `towards_camera` is a unit vector in LPS.
Image offset_image(const FloatImage& picture, const ScalarRange& range_mm,
                   const std::array<float, 3>& towards_camera);

/// Depths in greys, opaque on black, with a legend in mm.
Image depth_image(const FloatImage& picture, const ScalarRange& range_mm);

/// Red, green, blue = (1 + normal) / 2 of L, P, S; transparent where there is none.
Image normal_image(const FloatImage& picture);

}  // namespace supple
