// The three orthogonal slices of a live session, each filling its view: where they lie, and the
// pictures.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "lib/session/session.h"
#include "lib/state/state.h"
#include "raycast/drawings/painted_values.h"
#include "raycast/drawings/slice.h"
#include "tools/scene/file/slice_view.h"
#include "tools/scene/pictures/picture_options.h"
#include "tools/viewer/frame_message.h"
#include "volumes/base/table.h"

namespace supple::tools {

// Values painted over slices and over the picture in space: how far tissue has moved (mm), det F,
// or the density of strain energy, at the place that is seen.
//
// F is the gradient of the deformation at a place of the deformed body, the inverse of the central
// differences of where its surroundings, half a voxel on each side, were at rest. Strain energy is
// that of a Saint Venant-Kirchhoff solid, W = λ/2 (tr E)² + μ tr E², E = (FᵀF - 1)/2, with the
// Young's modulus and Poisson's ratio of the element's class (kPa, which is kJ/m³); ChainMail does
// not know of it. Across an open cut differences mean nothing. Cost: 7 rest places per pixel.

enum class FieldOverlay { none, displacement, det_f, energy };

/// det F: blue where tissue is pressed, red where it is stretched, grey where it is as it was.
ValueColours colours_of(FieldOverlay overlay);

/// kPa of an isotropic solid that has deformed by F between places of the grid.
double strain_energy_kpa(const GridGradient& f, const Geometry& geometry, double young_kpa,
                         double poisson);
/// Von Mises' measure of Cauchy's stress in the same solid, kPa.
double von_mises_kpa(const GridGradient& f, const Geometry& geometry, double young_kpa,
                     double poisson);

class OverlayField {
 public:
  /// Refers to the session's body and the opened state. `rest`: not null.
  OverlayField(FieldOverlay overlay, const Session& session, const State& opened,
               const RestPlaceAt& rest);
  /// The value at a place; none where no tissue is seen.
  std::optional<double> at(const Vec3d& index) const;
  /// Paints the values of at() in the colours of the overlay; clear where nothing is displaced,
  /// strained or changed in volume. Refers to this.
  ValuePaint paint(const ScalarRange& range) const;

 private:
  FieldOverlay m_overlay;
  const Session& m_session;
  const State& m_opened;
  const RestPlaceAt& m_rest;
  MaterialClasses m_classes;
};

/// A range for the energies of a body: up to what 99 % of its elements stay below, of which every
/// fourth along each axis is looked at.
double most_energy_kpa(const Session& session, const Displacement& moved);

struct SliceSettings {
  Vec3d cursor{0, 0, 0};  // index that all pass through
  double window = 400, level = 40;
  FieldOverlay overlay = FieldOverlay::none;
  bool overlay_in_space = false;  // too
  bool outline_in_space = false;  // of the body at rest, too
  bool outline = true;
  double zoom = 1;                             // 1: the whole slice fits
  std::array<std::optional<Vec3d>, 3> centre;  // index in the middle of each; absent: of the box
  std::array<std::optional<SliceAxes>, 3> turned;  // oblique ones
};
/// Fields but for `centre` and `turned`.
Fields fields(SliceSettings& settings);

/// Reads the axes of oblique slices by the names of their views, those of others are forgotten.
/// Throws InputError: axes that are no unit vectors at a right angle.
void read_turned(Table& table, SliceSettings& settings);

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
