#include "tools/scene/file/slice_view.h"

#include <algorithm>
#include <tuple>

#include "volumes/base/error.h"
#include "volumes/grid/density_grid.h"

namespace supple::tools {

namespace {

/// The usual abdominal and head window: level 40, width 400.
constexpr double kSoftTissueLo = -160, kSoftTissueHi = 240;

/// Soft tissue where densities are Hounsfield units, else everything there is; one density alone is
/// grey.
std::pair<double, double> default_window(const DensityGrid& density) {
  if (are_hounsfield_units(density.background())) return {kSoftTissueLo, kSoftTissueHi};
  float lo = density.background(), hi = lo;
  for (std::size_t b = 0; b < density.bricks().brick_count(); ++b) {
    const auto [least, most] =
        std::minmax_element(density.values(b), density.values(b) + kBrickVoxels);
    lo = std::min(lo, *least);
    hi = std::max(hi, *most);
  }
  if (hi > lo) return {lo, hi};
  return {double(lo) - 1, double(lo) + 1};
}

}  // namespace

SliceChoice placed_slice(const SliceChoice& choice, const Geometry& geometry) {
  SliceChoice placed = choice;
  if (!choice.at) placed.at = Vec3d((geometry.dims() - Vec3i(1)) / 2);
  if (choice.count() > 1 && choice.plane == "all") placed.plane = "axial";
  return placed;
}

SliceChoice effective_slice(const SliceChoice& choice, const Geometry& geometry,
                            const DensityGrid& density) {
  SliceChoice effective = placed_slice(choice, geometry);
  if (!choice.window) effective.window = default_window(density);
  SliceStyle style;
  std::tie(style.grey_lo, style.grey_hi) = *effective.window;
  style.validate();
  return effective;
}

Field sampling_field(Interpolation& interpolation) {
  return Field("sampling", interpolation, {"linear", "cubic", "interpolating"},
               "cubic smooths, interpolating keeps thin walls");
}

Fields fields(SliceChoice& choice) {
  Fields all = {
      Field("plane", choice.plane, "Which slices")
          .one_of({"axial", "coronal", "sagittal", "all"})
          .also("transverse", "axial")
          .also("transversal", "axial")
          .also("frontal", "coronal")
          .shown_as("PLANE"),
      Field("normal", choice.normal,
            "An oblique slice across this direction in LPS, which points "
            "to the viewer"),
      Field("up", choice.up, "Upwards in an oblique slice, in LPS")
          .otherwise("superior, of nearly axial ones anterior"),
      Field("at", choice.at, "Voxel that the slices pass through")
          .shown_as("I,J,K")
          .otherwise("the middle"),
      Field("window", choice.window, "Densities that are black and white")
          .shown_as("LO,HI")
          .otherwise("soft tissue with HU, else all"),
      Field("scale", choice.scale, "Pixels per voxel of the smallest spacing").range(0.01, 64),
      sampling_field(choice.interpolation),
      Field("thickness", choice.thickness_mm, "Of a slab around the slice")
          .unit("mm")
          .range(0, 10000)
          .otherwise("a plane"),
      Field("slab", choice.slab, {"mean", "mip", "minip"},
            "What a slab shows: mean, largest or least density"),
      Field("lightbox", choice.lightbox, "Columns and rows of parallel slices (axial unless told)")
          .range(1, 64)
          .shown_as("CxR")
          .otherwise("one slice"),
      Field("every", choice.every_mm, "Between slices of a lightbox")
          .unit("mm")
          .positive()
          .otherwise("evenly through the volume"),
      Field("outline", choice.outline, "Without the outline of the body at rest"),
  };
  for (const Field& mark : fields(choice.marks)) all.push_back(mark);
  return all;
}

void complete_slice(SliceChoice& choice, const std::string& place) {
  const auto refuse = [&](const char* field, const char* found, const char* expected) {
    throw InputError({place, field, found, expected});
  };
  if (choice.normal && choice.plane != "all") refuse("normal", "plane and normal", "one of both");
  if (choice.up && !choice.normal) refuse("up", "up without normal", "a normal beside it");
  if (choice.normal) oblique_axes(*choice.normal, choice.up);
  if (choice.every_mm && choice.count() == 1) {
    refuse("every", "every without lightbox", "a lightbox beside it");
  }
  if (choice.slab != SlabMode::mean && choice.thickness_mm == 0) {
    refuse("slab", "slab without thickness", "a thickness beside it");
  }
  read_marks(choice.marks, place);
}

std::vector<NamedAxes> axes_of(const SliceChoice& choice, const Geometry& geometry) {
  if (choice.normal) return {{"oblique", oblique_axes(*choice.normal, choice.up)}};
  std::vector<NamedAxes> all;
  for (const auto& [name, plane] : {std::pair("axial", SlicePlane::axial),
                                    {"coronal", SlicePlane::coronal},
                                    {"sagittal", SlicePlane::sagittal}}) {
    if (choice.plane == "all" || choice.plane == name) {
      all.push_back({name, slice_axes(geometry, plane)});
    }
  }
  return all;
}

}  // namespace supple::tools
