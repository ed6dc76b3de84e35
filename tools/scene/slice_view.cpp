#include "tools/scene/slice_view.h"

#include <algorithm>

#include "volumes/base/error.h"
#include "volumes/grid/volume.h"

namespace supple::tools {

namespace {

/// Between the slices of a row.
constexpr int kGapPixels = 8;

/// The usual abdominal and head window: level 40, width 400.
constexpr double kSoftTissueLo = -160, kSoftTissueHi = 240;

/// The density that is seen at a place: that of where its tissue came from.
DensityAt density_of(const SliceSource& source) {
  const float outside = source.density.background();
  if (source.offsets == nullptr) {
    return [&source, outside](const Vec3d& index) {
      return sample_trilinear(source.density, index, outside);
    };
  }
  const OffsetField& offsets = *source.offsets;
  return [&source, &offsets, outside](const Vec3d& index) {
    Vec3d offset;
    if (!offsets.sample(index, offset)) return outside;
    return sample_trilinear(source.density, index + offset, outside);
  };
}

/// Soft tissue where densities are Hounsfield units, else everything there is.
std::pair<double, double> default_window(const DensityGrid& density) {
  if (density.background() < -200) return {kSoftTissueLo, kSoftTissueHi};
  float lo = density.background(), hi = lo;
  for (std::size_t b = 0; b < density.bricks().brick_count(); ++b) {
    const auto [least, most] =
        std::minmax_element(density.values(b), density.values(b) + kBrickVoxels);
    lo = std::min(lo, *least);
    hi = std::max(hi, *most);
  }
  return {lo, std::max(hi, lo + 1)};
}

std::vector<SlicePlane> planes_of(const std::string& name) {
  if (name == "axial") return {SlicePlane::axial};
  if (name == "coronal") return {SlicePlane::coronal};
  if (name == "sagittal") return {SlicePlane::sagittal};
  return {SlicePlane::axial, SlicePlane::coronal, SlicePlane::sagittal};
}

SliceStyle style_of(const SliceSource& source, const SliceChoice& choice) {
  SliceStyle style;
  style.grey_lo = choice.window->first;
  style.grey_hi = choice.window->second;
  const bool is_outlined = choice.outline && source.rest != nullptr && !source.rest->empty();
  if (is_outlined) style.rest = source.rest;
  return style;
}

}  // namespace

SliceChoice effective_slice(const SliceChoice& choice, const SliceSource& source) {
  SliceChoice effective = choice;
  if (!choice.at) effective.at = Vec3d((source.geometry.dims() - Vec3i(1)) / 2);
  if (!choice.window) effective.window = default_window(source.density);
  style_of(source, effective).validate();
  return effective;
}

Image draw_slices(const SliceSource& source, const SliceChoice& choice) {
  const Vec3d spacing = source.geometry.spacing_mm();
  const double pixel_mm = std::min({spacing.x, spacing.y, spacing.z}) / choice.scale;
  std::vector<Image> images;
  for (const SlicePlane plane : planes_of(choice.plane)) {
    const Geometry slice = slice_grid(source.geometry, plane, *choice.at, pixel_mm);
    images.push_back(
        draw_slice(source.geometry, slice, density_of(source), style_of(source, choice)));
  }
  return side_by_side(images, kGapPixels);
}

SliceChoice read_slice(TomlTable& table) {
  SliceChoice choice;
  table.know({"plane", "at", "window", "scale", "outline"});
  choice.plane = table.string("plane").value_or(choice.plane);
  const std::vector<std::string> planes = {"axial", "coronal", "sagittal", "all"};
  if (std::find(planes.begin(), planes.end(), choice.plane) == planes.end()) {
    table.fail("plane", "\"" + choice.plane + "\"", "one of axial coronal sagittal all");
  }
  choice.at = table.vector("at");
  if (const auto window = table.numbers("window")) {
    if (window->size() != 2) table.fail("window", "another list", "two densities [lo, hi]");
    choice.window = {(*window)[0], (*window)[1]};
  }
  choice.scale = table.number("scale").value_or(choice.scale);
  choice.outline = table.boolean("outline").value_or(choice.outline);
  if (!(choice.scale >= 0.01 && choice.scale <= 64)) {
    table.fail("scale", number_text(choice.scale), "0.01 to 64");
  }
  table.finish();
  return choice;
}

}  // namespace supple::tools
