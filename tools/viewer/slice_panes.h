// The three orthogonal slices of a live session, each filling its view: where they lie, and the
// pictures.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "lib/state/state.h"
#include "raycast/drawings/slice.h"
#include "tools/scene/file/slice_view.h"
#include "tools/scene/pictures/picture_options.h"
#include "tools/viewer/frame_message.h"
#include "tools/viewer/overlay.h"

namespace supple::tools {

struct SliceSettings {
  Vec3d cursor{0, 0, 0};  // index that all pass through
  double window = 400, level = 40;
  FieldOverlay overlay = FieldOverlay::none;
  bool overlay_in_space = false;  // too
  bool outline_in_space = false;  // of the body at rest, too
  bool outline = true;
  double zoom = 1;                             // 1: the whole slice fits
  std::array<std::optional<Vec3d>, 3> centre;  // index in the middle of each; absent: of the box
};
/// Fields but for `centre`.
Fields fields(SliceSettings& settings);

/// Settings of slices through the middle of the volume, with the window of `supple slice`.
SliceSettings default_slices(const State& state);

struct SlicePane {
  Image image;
  PixelFrame pixels;
};

/// The frame of the pixels of a pane.
PixelFrame pane_pixels(const Geometry& geometry, const SliceSettings& settings, int plane,
                       const PixelSize& size);

/// Draws pane 0 axial, 1 coronal or 2 sagittal, on `size` pixels. `rest`: null for a body at rest.
/// `overlay`: null: none. `every`: only every so many-th pixel, for haste.
SlicePane draw_pane(const State& state, const SliceSettings& settings, int plane,
                    const PixelSize& size, const RestPlaceAt& rest, const OverlayField* overlay,
                    const ScalarRange& range, int every);

}  // namespace supple::tools
