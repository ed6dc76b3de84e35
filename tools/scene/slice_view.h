// Slices as `supple slice` and a scene's [[view]] ask for them.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "raycast/drawings/slice.h"
#include "volumes/base/fields.h"
#include "volumes/field/offset_field.h"
#include "volumes/grid/density_grid.h"

namespace supple::tools {

struct SliceChoice {
  std::string plane = "all";  // axial, coronal, sagittal, or all of them
  std::optional<Vec3d> at;    // voxel that they pass through; absent: the middle
  /// Densities that are black and white; absent: soft tissue with HU, else all.
  std::optional<NumberPair> window;
  double scale = 2;  // pixels per voxel of the smallest spacing
  bool outline = true;
};

/// What is cut.
struct SliceSource {
  const Geometry& geometry;
  const DensityGrid& density;
  const BrickTopology* rest;   // outlined; null: nothing
  const OffsetField* offsets;  // null: straight
};

/// The choice with everything decided that was left open. Throws InputError: a bad window.
SliceChoice effective_slice(const SliceChoice& choice, const SliceSource& source);

/// One slice, or three side by side, of an effective choice.
Image draw_slices(const SliceSource& source, const SliceChoice& choice);

/// Of `slice = { … }` in a [[view]].
Fields fields(SliceChoice& choice);

}  // namespace supple::tools
