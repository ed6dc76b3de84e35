// Slices as `supple slice` and a scene's [[view]] ask for them.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "raycast/drawings/slice.h"
#include "tools/scene/file/tissue_marks.h"
#include "volumes/base/fields.h"
#include "volumes/grid/density_grid.h"

namespace supple::tools {

struct SliceChoice {
  std::string plane = "all";    // axial, coronal, sagittal, or all of them
  std::optional<Vec3d> normal;  // LPS, to the viewer: one oblique slice instead
  std::optional<Vec3d> up;      // LPS, of an oblique slice
  std::optional<Vec3d> at;      // voxel that they pass through; absent: the middle
  /// Densities that are black and white; absent: soft tissue with HU, else all.
  std::optional<NumberPair> window;
  Interpolation interpolation = Interpolation::linear;
  double scale = 2;         // pixels per voxel of the smallest spacing
  double thickness_mm = 0;  // of a slab; 0: a plane
  SlabMode slab = SlabMode::mean;
  PixelSize lightbox{1, 1};        // columns and rows of parallel slices
  std::optional<double> every_mm;  // between them; absent: all the way through the volume
  bool outline = true;
  TissueMarks marks;

  int count() const { return lightbox[0] * lightbox[1]; }
};

/// The choice with its place and planes decided.
SliceChoice placed_slice(const SliceChoice& choice, const Geometry& geometry);
/// The choice with everything decided that was left open. Throws InputError: a bad window.
SliceChoice effective_slice(const SliceChoice& choice, const Geometry& geometry,
                            const DensityGrid& density);

/// Key for how densities between voxels are read, in slices and pictures in space.
Field sampling_field(Interpolation& interpolation);

/// Keys of `slice = { … }` in a [[view]].
Fields fields(SliceChoice& choice);

/// Reads the files that the choice names. Throws InputError: as a volume file, and settings that
/// do not go together, with `place`.
void complete_slice(SliceChoice& choice, const std::string& place);

/// Names of the planes of a choice, and how pictures of them lie in space.
struct NamedAxes {
  std::string name;
  SliceAxes axes;
};
std::vector<NamedAxes> axes_of(const SliceChoice& choice, const Geometry& geometry);

}  // namespace supple::tools
