// Scalars as colours, and the ticks of their legends.
#pragma once

#include "raycast/pictures/image.h"
#include "volumes/base/fields.h"

namespace supple {

/// Values that the ends of the map stand for.
struct ScalarRange {
  double lo = 0, hi = 1;
};
/// Range of the values that are numbers; 0…1 without any.
ScalarRange range_of(const std::vector<float>& values);

/// Ticks at multiples of 1, 2 or 5 times a power of ten, four to eight of them.
std::vector<double> legend_ticks(const ScalarRange& range);

/// Colour of an offset by its share of the longest, 0 to 1: part of magma from light to dark,
/// uniform in perceived lightness, so that tissue at rest is light and keeps its relief.
Rgb offset_colour(double share);

/// Red, green, blue = (1 + normal) / 2 of L, P, S; transparent where there is none.
Image normal_image(const FloatImage& picture);

}  // namespace supple
