// Values of tissue in colour over what is seen: how far it has moved, by how much its volume has
// changed, or what a volume of values says of it (stress, dose, activity). The colour is mixed with
// the picture, so that its greys or its relief stay.
//
// Cost: one value per pixel, all threads.
#pragma once

#include <array>
#include <functional>
#include <optional>

#include "raycast/drawings/rest_place.h"
#include "raycast/pictures/colour_map.h"
#include "raycast/pictures/image.h"
#include "raycast/scene/camera.h"

namespace supple {

/// The value of what is seen at a place of the volume's index space; none: nothing is painted.
using ValueAt = std::function<std::optional<double>(const Vec3d& index)>;

/// det F at the ends of its colours, unless told.
constexpr ScalarRange kVolumeRatios{0.5, 1.5};

/// Colours from light to dark, or from blue over grey to red for values about a middle.
enum class ValueColours { ascending, about_middle };
/// Colour of a value by its share of the way through a range, 0 to 1.
Rgb value_colour(ValueColours colours, double share);

/// Values beyond the range have the colours of its ends.
struct ValuePaint {
  ValueAt value;
  ScalarRange range;
  ValueColours colours = ValueColours::ascending;
  /// The value of what is as it was: nothing is painted there, and little beside it.
  std::optional<double> clear = {};

  /// Colour of a value in the range or beyond it.
  Rgb colour(double of) const;
  /// Share of the colour in what is seen.
  double share(double of) const;
};

/// Paints over the opaque pixels of a slice whose pixels lie on `grid`; a slab by its middle.
void paint_values(Image& slice, const Geometry& grid, const ValuePaint& paint,
                  const Geometry& geometry);
/// Paints what is seen in space, by its lightness; the picture has its depths. Surfaces stay as
/// they are where the picture tells them.
void paint_values(FloatImage& picture, const Camera& camera, const ValuePaint& paint,
                  const Geometry& geometry);

/// Columns of a gradient: what one step along each grid axis leads to, in voxels.
using GridGradient = std::array<Vec3d, 3>;
double determinant(const GridGradient& gradient);

/// The deformation gradient F at a place of the deformed body: the inverse of the central
/// differences, half a voxel to each side, of where tissue was at rest. None where a place around
/// is not known, or det F⁻¹ is nearly 0.
std::optional<GridGradient> deformation_at(const RestPlaceAt& rest, const Vec3d& index);
/// Columns of a gradient by central differences of places, half a voxel to each side.
std::optional<GridGradient> gradient_at(
    const Vec3d& index, const std::function<bool(const Vec3d& index, Vec3d& place)>& at);

}  // namespace supple
