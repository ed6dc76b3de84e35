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
  if (are_hounsfield_units(density.background())) return {kSoftTissueLo, kSoftTissueHi};
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

Fields fields(SliceChoice& choice) {
  return {
      Field("plane", choice.plane, "Which slices")
          .one_of({"axial", "coronal", "sagittal", "all"})
          .also("transverse", "axial")
          .also("transversal", "axial")
          .also("frontal", "coronal")
          .shown_as("PLANE"),
      Field("at", choice.at, "Voxel that the slices pass through")
          .shown_as("I,J,K")
          .otherwise("the middle"),
      Field("window", choice.window, "Densities that are black and white")
          .shown_as("LO,HI")
          .otherwise("soft tissue with HU, else all"),
      Field("scale", choice.scale, "Pixels per voxel of the smallest spacing").range(0.01, 64),
      Field("outline", choice.outline, "Without the outline of the body at rest"),
  };
}

}  // namespace supple::tools
