#include "tools/viewer/slice_panes.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <tbb/parallel_for.h>

#include "raycast/pictures/colour_map.h"
#include "raycast/scene/camera.h"
#include "volumes/grid/volume.h"

namespace supple::tools {

namespace {

constexpr double kOverlayShare = 0.55;  // of the colour, over the grey

/// Where a pane's pixels lie.
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

/// det F of the tissue at a place, from where its surroundings were at rest; 1 where those are not
/// known.
double determinant_at(const RestPlaceAt& rest, const Vec3d& index) {
  Vec3d columns[3];
  for (int a = 0; a < 3; ++a) {
    Vec3d step(0), ahead, behind;
    step[a] = 0.5;
    if (!rest(index + step, ahead) || !rest(index - step, behind)) return 1;
    columns[a] = ahead - behind;
  }
  const double inverse = columns[0].dot(columns[1].cross(columns[2]));
  return std::abs(inverse) < 1e-6 ? 1 : 1 / inverse;
}

void paint_overlay(Image& image, const Geometry& grid, const State& state, SliceOverlay overlay,
                   const RestPlaceAt& rest, const OverlayRange& range) {
  const Geometry& geometry = state.geometry;
  tbb::parallel_for(0, image.height, [&](int y) {
    for (int x = 0; x < image.width; ++x) {
      const Vec3d index = geometry.index_from_world(grid.world_from_index(Vec3d(x, y, 0)));
      Vec3d at_rest;
      if (!rest(index, at_rest)) continue;
      const Vec3i voxel(int(std::lround(at_rest.x)), int(std::lround(at_rest.y)),
                        int(std::lround(at_rest.z)));
      if (!state.elements.is_active(voxel)) continue;
      const double value = overlay == SliceOverlay::det_f
                               ? determinant_at(rest, index)
                               : geometry.world_vector_from_index(index - at_rest).length();
      const Rgb colour =
          overlay_colour(overlay, std::clamp((value - range.lo) / (range.hi - range.lo), 0., 1.));
      std::uint8_t* pixel = &image.rgba[4 * (std::size_t(y) * image.width + x)];
      for (std::size_t c = 0; c < 3; ++c) {
        pixel[c] = std::uint8_t(
            std::lround((1 - kOverlayShare) * pixel[c] + kOverlayShare * 255 * colour[c]));
      }
    }
  });
}

}  // namespace

Fields fields(SliceSettings& settings) {
  return {
      Field("cursor", settings.cursor, "Index that all slices pass through").range(-1e5, 1e5),
      Field("window", settings.window, "Densities from black to white").range(1e-6, 1e9),
      Field("level", settings.level, "Density in the middle of them").range(-1e9, 1e9),
      Field("overlay", settings.overlay, {"none", "displacement", "det_f"},
            "What is painted over the densities"),
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

/// det F: blue where tissue is pressed, red where it is stretched, grey where it is as it was.
Rgb overlay_colour(SliceOverlay overlay, double share) {
  if (overlay == SliceOverlay::displacement) return offset_colour(share);
  const double towards = std::abs(2 * share - 1);
  const Rgb end = share < 0.5 ? Rgb{0.13, 0.4, 0.85} : Rgb{0.84, 0.19, 0.15};
  Rgb colour;
  for (std::size_t c = 0; c < 3; ++c) colour[c] = 0.87 + (end[c] - 0.87) * towards;
  return colour;
}

PixelFrame pane_pixels(const Geometry& geometry, const SliceSettings& settings, int plane,
                       const PixelSize& size) {
  const Geometry grid = pane_grid(geometry, settings, plane, size);
  return {grid.origin_lps_mm(), grid.axes_mm()[0], grid.axes_mm()[1]};
}

SlicePane draw_pane(const State& state, const SliceSettings& settings, int plane,
                    const PixelSize& size, const RestPlaceAt& rest, const OverlayRange& range,
                    int every) {
  const Geometry& geometry = state.geometry;
  const PixelSize drawn{std::max(1, size[0] / every), std::max(1, size[1] / every)};
  const Geometry grid = pane_grid(geometry, settings, plane, drawn);
  const float outside = state.density.background();
  const DensityAt density = [&](const Vec3d& index) {
    if (!rest) return sample_trilinear(state.density, index, outside);
    Vec3d at_rest;
    return rest(index, at_rest) ? sample_trilinear(state.density, at_rest, outside) : outside;
  };
  SliceStyle style;
  style.grey_lo = settings.level - settings.window / 2;
  style.grey_hi = settings.level + settings.window / 2;
  if (settings.outline && rest) style.rest = &state.elements;
  style.rest_place = rest;
  SlicePane pane;
  pane.image = draw_slice(geometry, grid, density, style);
  if (settings.overlay != SliceOverlay::none && rest) {
    paint_overlay(pane.image, grid, state, settings.overlay, rest, range);
  }
  pane.pixels = pane_pixels(geometry, settings, plane, size);
  return pane;
}

}  // namespace supple::tools
