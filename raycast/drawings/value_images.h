// Pictures of depth and offset length, each with a legend in a strip to its right.
#pragma once

#include <array>

#include "raycast/pictures/colour_map.h"

namespace supple {

/// Pictures that are lower than this get no legend: it would not be legible.
constexpr int kLowestWithLegend = 160;

/// Offset lengths in the colours of offset_colour(), lit from the camera so that the surface can be
/// seen, opaque on white, with a legend in mm. `towards_camera` is a unit vector in LPS.
Image offset_image(const FloatImage& picture, const ScalarRange& range_mm,
                   const std::array<float, 3>& towards_camera);

/// Depths in greys, near is bright, opaque on black, with a legend in mm.
Image depth_image(const FloatImage& picture, const ScalarRange& range_mm);

}  // namespace supple
