// The three orthogonal slices of a live session, each filling its view: where they lie, what is
// painted over them, and the pictures.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "raycast/drawings/slice.h"
#include "tools/pictures/picture_options.h"
#include "tools/scene/slice_view.h"
#include "tools/viewer/frame_message.h"
#include "volumes/state/state.h"

namespace supple::tools {

enum class SliceOverlay { none, displacement, det_f };

struct SliceSettings {
  Vec3d cursor{0, 0, 0};  // index that all pass through
  double window = 400, level = 40;
  SliceOverlay overlay = SliceOverlay::none;
  bool outline = true;
  double zoom = 1;                             // 1: the whole slice fits
  std::array<std::optional<Vec3d>, 3> centre;  // index in the middle of each; absent: of the box
};
/// But for `centre`.
Fields fields(SliceSettings& settings);

/// What is seen in the middle of the volume, with the window of `supple slice`.
SliceSettings default_slices(const State& state);

/// Of the map that an overlay is painted with.
struct OverlayRange {
  double lo = 0, hi = 1;
};
Rgb overlay_colour(SliceOverlay overlay, double share);

struct SlicePane {
  Image image;
  PixelFrame pixels;
};

/// Where the pixels of a pane lie.
PixelFrame pane_pixels(const Geometry& geometry, const SliceSettings& settings, int plane,
                       const PixelSize& size);

/// One of 0 axial, 1 coronal, 2 sagittal, on `size` pixels. `rest`: null for a body at rest.
/// `every`: only so many-th pixels, for haste.
SlicePane draw_pane(const State& state, const SliceSettings& settings, int plane,
                    const PixelSize& size, const RestPlaceAt& rest, const OverlayRange& range,
                    int every);

}  // namespace supple::tools
