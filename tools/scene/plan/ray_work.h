// Number of samples that a picture reads, and of their bricks, without drawing it: a few of its
// rays go through the volume at rest, half a voxel at a time and with the nearest voxel's density.
//
// Deformation is not seen, and neither are clips, meshes and rays towards lights.
// Cost: 50 ns per voxel on the way, 0.1 s at most for usual volumes.
#pragma once

#include "raycast/march/render_settings.h"
#include "raycast/scene/camera.h"
#include "raycast/scene/transfer_function.h"
#include "tools/scene/file/slice_view.h"
#include "volumes/geometry/geometry.h"
#include "volumes/grid/density_grid.h"

namespace supple::tools {

struct PictureWork {
  double samples = 0;  // of all pixels
  double bricks = 0;   // in which any of those rays read
};
PictureWork picture_work(const DensityGrid& density, const Geometry& geometry, const Camera& camera,
                         const TransferFunction& function, const RenderSettings& settings);

/// Pixels of slices: an axial, a coronal and a sagittal one side by side, or those of a lightbox.
double slice_pixels(const SliceChoice& slice, const Geometry& geometry);

}  // namespace supple::tools
