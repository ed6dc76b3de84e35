#include "tools/viewer/slice_panes.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "raycast/scene/camera.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/density_grid.h"

namespace supple::tools {

namespace {

/// The grid of a pane's pixels.
Geometry pane_grid(const Geometry& geometry, const SliceSettings& settings, int plane,
                   const PixelSize& size) {
  const SliceAxes axes = slice_axes(geometry, SlicePlane(plane));
  Vec3d lo(1e300), hi(-1e300);
  for (const Vec3d& corner : box_corners_lps_mm(geometry)) {
    const Vec3d at(corner.dot(axes.right), corner.dot(axes.down), 0);
    for (int a = 0; a < 2; ++a) {
      lo[a] = std::min(lo[a], at[a]);
      hi[a] = std::max(hi[a], at[a]);
    }
  }
  const double pixel_mm =
      std::max((hi.x - lo.x) / size[0], (hi.y - lo.y) / size[1]) / settings.zoom;
  const Vec3d cursor = geometry.world_from_index(settings.cursor);
  double across = (lo.x + hi.x) / 2, down = (lo.y + hi.y) / 2;
  if (const auto& centre = settings.centre[std::size_t(plane)]) {
    const Vec3d at = geometry.world_from_index(*centre);
    across = at.dot(axes.right);
    down = at.dot(axes.down);
  }
  const Vec3d first =
      cursor + axes.right * (across - cursor.dot(axes.right) - pixel_mm * (size[0] - 1) / 2) +
      axes.down * (down - cursor.dot(axes.down) - pixel_mm * (size[1] - 1) / 2);
  return Geometry({size[0], size[1], 1}, first,
                  {axes.right * pixel_mm, axes.down * pixel_mm, axes.right.cross(axes.down)});
}

}  // namespace

Fields fields(SliceSettings& settings) {
  return {
      Field("cursor", settings.cursor, "Index that all slices pass through").range(-1e5, 1e5),
      Field("window", settings.window, "Densities from black to white").range(1e-6, 1e9),
      Field("level", settings.level, "Density in the middle of them").range(-1e9, 1e9),
      Field("overlay", settings.overlay, {"none", "displacement", "det_f", "energy"},
            "What is painted over the densities"),
      Field("overlay_in_space", settings.overlay_in_space, "Over the view in space, too"),
      Field("outline_in_space", settings.outline_in_space, "Over the view in space, too"),
      Field("outline", settings.outline, "The outline of the body at rest"),
      Field("zoom", settings.zoom, "Magnification").range(0.05, 100),
  };
}

SliceSettings default_slices(const State& state) {
  const SliceChoice choice = effective_slice({}, state.geometry, state.density);
  const auto [lo, hi] = *choice.window;
  SliceSettings settings;
  settings.cursor = *choice.at;
  settings.window = hi - lo;
  settings.level = (lo + hi) / 2;
  return settings;
}

PixelFrame pane_pixels(const Geometry& geometry, const SliceSettings& settings, int plane,
                       const PixelSize& size) {
  const Geometry grid = pane_grid(geometry, settings, plane, size);
  return {grid.origin_lps_mm(), grid.axes_mm()[0], grid.axes_mm()[1]};
}

SlicePane draw_pane(const State& state, const SliceSettings& settings, int plane,
                    const PixelSize& size, const RestPlaceAt& rest, const OverlayField* overlay,
                    const ScalarRange& range, int every) {
  const Geometry& geometry = state.geometry;
  const PixelSize drawn{std::max(1, size[0] / every), std::max(1, size[1] / every)};
  const Geometry grid = pane_grid(geometry, settings, plane, drawn);
  const float outside = state.density.background();
  const DensityAt density = [&](const Vec3d& index) {
    Vec3d at_rest = within_border(index, geometry.dims());
    return !rest || rest(index, at_rest) ? sample_trilinear(state.density, at_rest, outside)
                                         : outside;
  };
  SliceStyle style;
  style.grey_lo = settings.level - settings.window / 2;
  style.grey_hi = settings.level + settings.window / 2;
  if (settings.outline && rest) style.rest = &state.elements;
  style.rest_place = rest;
  if (overlay != nullptr) {
    style.paint = [&](Image& slice) { paint_values(slice, grid, overlay->paint(range), geometry); };
  }
  SlicePane pane;
  pane.image = draw_slice(geometry, grid, density, style);
  pane.pixels = pane_pixels(geometry, settings, plane, size);
  return pane;
}

}  // namespace supple::tools
