// A slice of a volume as a grey picture, with outlines, labels and a grid over it. A slab gathers
// densities along the line of sight, over its thickness.
//
// Cost: one density per pixel and, in a slab, per smallest voxel of its thickness; all threads.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "raycast/drawings/rest_place.h"
#include "raycast/drawings/slice_grid.h"
#include "raycast/pictures/image.h"
#include "volumes/grid/brick_topology.h"

namespace supple {

/// Reduction of the densities along the thickness of a slab.
enum class SlabMode { mean, maximum, minimum };

/// A density at a position of the volume's index space.
using DensityAt = std::function<float(const Vec3d& index)>;
/// The label of tissue by its index position at rest; 0: none.
using LabelAt = std::function<std::int64_t(const Vec3d& at_rest)>;

/// Densities that map to black and white, and drawings over them.
struct SliceStyle {
  double grey_lo = 0, grey_hi = 255;
  double thickness_mm = 0;  // of a slab; 0: a plane
  SlabMode slab = SlabMode::mean;
  const BrickTopology* rest = nullptr;  // whose outline is drawn; null: none
  std::array<std::uint8_t, 3> outline = {255, 200, 0};
  RestPlaceAt rest_place;             // null: tissue is at rest
  LabelAt label;                      // outlined in label_colour; null: none
  std::function<void(Image&)> paint;  // over the greys, below all drawings; null: nothing
  double grid_mm = 0;                 // distance of lines that were straight at rest; 0: none
  std::array<std::uint8_t, 3> grid = {90, 200, 255};

  /// Throws InputError: grey_lo and grey_hi not finite and ascending, negative lengths.
  void validate() const;
};

/// Colours that are easy to tell apart for small labels, the same in every picture.
std::array<std::uint8_t, 3> label_colour(std::int64_t label);

/// The densities on a slice's grid as a grey picture, opaque inside the volume's box and
/// transparent outside.
Image draw_slice(const Geometry& geometry, const Geometry& slice, const DensityAt& density,
                 const SliceStyle& style);

/// The top left pixel of a picture in a table.
struct TilePlace {
  int left, top;
};
/// Puts pictures in rows of `columns`, each at the top left of its cell, transparent between;
/// `places`: those of the pictures, in their order.
Image tiled(const std::vector<Image>& images, int columns, int gap,
            std::vector<TilePlace>* places = nullptr);

}  // namespace supple
