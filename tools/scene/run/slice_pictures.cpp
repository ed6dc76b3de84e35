#include "tools/scene/run/slice_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <tuple>

#include "raycast/drawings/annotations.h"
#include "raycast/pictures/background.h"
#include "tools/scene/run/overlay_paint.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/grid/b_spline.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/density_grid.h"
#include "volumes/io/bytes/value_type.h"

namespace supple::tools {

namespace {

/// Between slices.
constexpr int kGapPixels = 8;

/// One slice of the picture.
struct SlicePanel {
  std::string name;
  Geometry grid;
  Vec3d through_index;
  TilePlace place{0, 0};

  PictureArea area() const {
    return {double(place.left), double(place.top), double(grid.dims().x), double(grid.dims().y)};
  }
  /// The pixel of a position of the source's index frame.
  PixelPoint pixel_of(const Geometry& source, const Vec3d& index) const {
    const Vec3d at = grid.index_from_world(source.world_from_index(index));
    return {place.left + at.x + 0.5, place.top + at.y + 0.5};
  }
};

/// Densities between the voxels of the source.
DensityAt density_between(const SliceSource& source, Interpolation interpolation) {
  if (interpolation == Interpolation::linear) {
    const float outside = source.density.background();
    return [&source, outside](const Vec3d& index) {
      return sample_trilinear(source.density, index, outside);
    };
  }
  const auto spline = std::make_shared<const SplineDensity>(
      source.density, source.geometry.dims(), interpolation == Interpolation::interpolating);
  return [spline](const Vec3d& index) { return float(spline->at(index)); };
}

/// The density that is seen at a place: that of where its tissue came from.
DensityAt seen_density(const SliceSource& source, Interpolation interpolation) {
  DensityAt at_rest = density_between(source, interpolation);
  if (source.offsets == nullptr) {
    return [&source, at_rest](const Vec3d& index) {
      return at_rest(within_border(index, source.geometry.dims()));
    };
  }
  const float outside = source.density.background();
  const OffsetField& offsets = *source.offsets;
  return [&offsets, outside, at_rest](const Vec3d& index) {
    Vec3d place;
    return offsets.source_of(index, place) ? at_rest(place) : outside;
  };
}

SliceStyle slice_style(const SliceSource& source, const SliceChoice& choice) {
  SliceStyle style;
  std::tie(style.grey_lo, style.grey_hi) = *choice.window;
  style.thickness_mm = choice.thickness_mm;
  style.slab = choice.slab;
  style.grid_mm = choice.marks.grid_mm.value_or(0);
  const bool is_outlined = choice.outline && source.rest != nullptr && !source.rest->empty();
  if (is_outlined) style.rest = source.rest;
  if (source.offsets != nullptr) style.rest_place = rest_place_of(*source.offsets);
  if (choice.marks.labels != nullptr) {
    const StoredLabels& labels = *choice.marks.labels;
    const ScaleValues to_number = scale_values_of(labels.type());
    style.label = [&labels, &source, to_number](const Vec3d& at_rest) {
      char stored[8] = {};
      labels.nearest(source.geometry.world_from_index(at_rest), stored);
      double label = 0;
      to_number(stored, 1, 1, 0, &label);
      return std::int64_t(label);
    };
  }
  return style;
}

std::vector<SlicePanel> panels_of(const SliceChoice& choice, const Geometry& geometry) {
  const Vec3d spacing = geometry.spacing_mm();
  const double pixel_mm = std::min({spacing.x, spacing.y, spacing.z}) / choice.scale;
  std::vector<SlicePanel> panels;
  for (const auto& [name, axes] : axes_of(choice, geometry)) {
    std::vector<Vec3d> places = {*choice.at};
    if (choice.count() > 1) {
      slice_grid(geometry, axes, *choice.at, pixel_mm);  // refuses a place outside the box
      places = stacked_places(geometry, axes, *choice.at, choice.count(), choice.every_mm);
      if (places.empty()) {
        throw InputError({"", "every", number_text(*choice.every_mm) + " mm, all slices outside",
                          "less than the volume is thick"});
      }
    }
    for (const Vec3d& place : places) {
      panels.push_back({name, slice_grid(geometry, axes, place, pixel_mm), place});
    }
  }
  return panels;
}

/// Writes "L 12.0": the distance towards a side.
std::string side_and_distance(int axis, double lps) {
  Vec3d direction(0);
  direction[axis] = lps < 0 ? -1 : 1;
  return orientation_letters(direction) + " " + decimal_text(std::abs(lps), 1);
}

std::vector<std::string> words_of(const SlicePanel& panel, const SliceChoice& choice,
                                  const Geometry& geometry) {
  const Vec3d place = geometry.world_from_index(panel.through_index);
  const Vec3d normal = panel.grid.direction()[2];
  std::string position;
  for (int axis = 0; axis < 3; ++axis) {
    // An axis of the patient's is said alone where the slice lies across it.
    const bool is_across = std::abs(normal[axis]) > 0.999;
    if (is_across) position = side_and_distance(axis, place[axis]);
    if (is_across) break;
    position += (axis > 0 ? " " : "") + side_and_distance(axis, place[axis]);
  }
  std::vector<std::string> lines = {panel.name + "  " + position + " mm"};
  const auto [lo, hi] = *choice.window;
  lines.push_back("W " + number_text(hi - lo) + "  L " + number_text((lo + hi) / 2));
  if (choice.thickness_mm > 0) {
    const char* names[] = {"mean", "MIP", "MinIP"};
    lines.push_back(std::string(names[int(choice.slab)]) + " of " +
                    number_text(choice.thickness_mm) + " mm");
  }
  return lines;
}

void annotate(Annotations& annotations, const SlicePanel& panel, const SliceSource& source,
              const SliceChoice& choice, const Decoration& decoration) {
  const auto axes = panel.grid.direction();
  if (decoration.shows("crosshair")) {
    annotations.crosshair(panel.pixel_of(source.geometry, *choice.at));
  }
  if (decoration.shows("letters")) annotations.letters(axes[0], -axes[1]);
  if (decoration.shows("scale")) annotations.scale_bar(panel.grid.spacing_mm().x, "");
  if (decoration.shows("text")) annotations.words(words_of(panel, choice, source.geometry));
}

void add_legend(Annotations& annotations, const SliceSource& source, const SliceChoice& choice,
                const ValuePaint* paint) {
  const auto [lo, hi] = *choice.window;
  const auto grey = [lo = lo, hi = hi](double value) {
    const double share = (value - lo) / (hi - lo);
    return Rgb{share, share, share};
  };
  const bool is_ct = are_hounsfield_units(source.density.background());
  const int count = paint != nullptr ? 2 : 1;
  annotations.legend({lo, hi}, grey, is_ct ? "HU" : "density", 0, count);
  if (paint != nullptr) add_overlay_legend(annotations, choice.marks, *paint, 1, count);
}

/// Adds arrows from where the tissue at places of a regular pattern came.
void add_arrows(Annotations& annotations, const SlicePanel& panel, const SliceSource& source,
                double arrows_mm) {
  const double step = arrows_mm / panel.grid.spacing_mm().x;
  const Vec3i dims = panel.grid.dims();
  for (double y = 0.5 * std::fmod(dims.y, step); y < dims.y; y += step) {
    for (double x = 0.5 * std::fmod(dims.x, step); x < dims.x; x += step) {
      const Vec3d place = panel.grid.world_from_index({x - 0.5, y - 0.5, 0});
      const Vec3d index = source.geometry.index_from_world(place);
      Vec3d offset;
      if (!source.offsets->sample(index, offset)) continue;
      annotations.arrow(panel.pixel_of(source.geometry, index + offset),
                        panel.pixel_of(source.geometry, index));
    }
  }
}

/// Height of letters that all panels share: the one that suits the smallest.
double common_letter_height(const std::vector<SlicePanel>& panels) {
  double height = Annotations::letter_height_for(panels.front().area());
  for (const SlicePanel& panel : panels) {
    height = std::min(height, Annotations::letter_height_for(panel.area()));
  }
  return height;
}

}  // namespace

std::vector<ViewVolume> seen_of(const SliceChoice& choice, const Geometry& geometry) {
  std::vector<ViewVolume> volumes;
  for (const SlicePanel& panel : panels_of(placed_slice(choice, geometry), geometry)) {
    volumes.emplace_back(panel.grid, choice.thickness_mm, geometry);
  }
  return volumes;
}

FloatImage draw_slices(const SliceSource& source, const SliceChoice& choice,
                       const Decoration& decoration) {
  const auto require_motion = [&](bool shows_motion, const char* field) {
    if (!shows_motion || source.offsets != nullptr) return;
    throw InputError({"", field, "nothing that has moved", "a deformed state or a warp"});
  };
  require_motion(choice.marks.arrows_mm.has_value(), "arrows");
  require_motion(choice.marks.shows_displacement() || choice.marks.shows_det_f(), "overlay");
  std::vector<SlicePanel> panels = panels_of(choice, source.geometry);
  SliceStyle style = slice_style(source, choice);
  const PaintedBody painted{source.geometry, source.elements, style.rest_place};
  std::optional<ValuePaint> paint;
  if (!choice.marks.overlay.empty()) {
    paint = overlay_paint(choice.marks, painted, PaintEdge::halfway);
  }
  const DensityAt seen = seen_density(source, choice.interpolation);
  std::vector<Image> images;
  for (const SlicePanel& panel : panels) {
    if (paint) {
      style.paint = [&](Image& slice) { paint_values(slice, panel.grid, *paint, source.geometry); };
    }
    images.push_back(draw_slice(source.geometry, panel.grid, seen, style));
  }
  const int columns = choice.count() > 1 ? choice.lightbox[0] : int(images.size());
  std::vector<TilePlace> places;
  FloatImage picture = to_float(tiled(images, columns, kGapPixels, &places));

  const std::string& named = decoration.background;
  const Background behind = parse_background(named.empty() ? "black" : named);
  put_over(behind, picture);

  Overlay overlay;
  const double letter_height = common_letter_height(panels);
  for (std::size_t n = 0; n < panels.size(); ++n) {
    SlicePanel& panel = panels[n];
    panel.place = places[n];
    Annotations annotations(overlay, panel.area(), letter_height, Ground::dark);
    if (choice.marks.arrows_mm) add_arrows(annotations, panel, source, *choice.marks.arrows_mm);
    annotate(annotations, panel, source, choice, decoration);
    const bool is_last = n + 1 == panels.size();
    if (decoration.shows("legend") && is_last) {
      add_legend(annotations, source, choice, paint ? &*paint : nullptr);
    }
  }
  if (!overlay.empty()) draw_overlay(picture, overlay);
  return picture;
}

}  // namespace supple::tools
