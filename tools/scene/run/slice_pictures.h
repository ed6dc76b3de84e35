// Pictures of slices: one, three side by side, or a lightbox, with drawings and annotations over
// them.
#pragma once

#include <vector>

#include "raycast/pictures/image.h"
#include "raycast/scene/view_volume.h"
#include "tools/scene/file/slice_view.h"
#include "tools/scene/pictures/decoration.h"
#include "volumes/field/offset_field.h"

namespace supple::tools {

/// The volume that slices cut, with its outlines and offsets.
struct SliceSource {
  const Geometry& geometry;
  const DensityGrid& density;
  const BrickTopology* rest;      // outlined; null: nothing
  const OffsetField* offsets;     // null: straight
  const BrickTopology& elements;  // that overlays are painted on
};

/// Parts of the volume that slices of a choice show. Throws InputError: a place outside of it.
std::vector<ViewVolume> seen_of(const SliceChoice& choice, const Geometry& geometry);

/// Draws an effective choice. Throws InputError: a place outside the volume, arrows of a volume at
/// rest.
FloatImage draw_slices(const SliceSource& source, const SliceChoice& choice,
                       const Decoration& decoration);

}  // namespace supple::tools
