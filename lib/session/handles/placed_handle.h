// Handles and anchors as people write them, on the command line and in scenes: voxels, boxes,
// balls, densities, connected pieces, files of points and labels; shifted, turned and scaled. Their
// places are in one of three frames; a session finds them on its grid (handles.h).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "volumes/base/fields.h"
#include "volumes/base/value.h"
#include "volumes/geometry/pose_path.h"
#include "volumes/io/point_file.h"

namespace supple {

/// Frames of places: voxels, with directions in millimetres along the grid axes i, j, k; or
/// millimetres in the patient.
enum class PlaceFrame { voxel, lps, ras };

/// Exactly one of box, at_lps_mm, points, label and ball, or none beside density, piece_at or
/// rigid_at, which narrow a box or a ball.
struct PlacedSelection {
  std::string place;  // "file:line" of a scene, for errors
  Value keys;         // all this as written, and of a handle how it holds; null: a program's
  PlaceFrame frame = PlaceFrame::voxel;
  std::optional<std::array<Vec3d, 2>> corners;  // of a box; a voxel is a box of one
  std::optional<Vec3d> at_lps_mm;
  std::optional<PointFile> points;
  std::optional<std::int32_t> label;
  std::optional<Vec3d> ball;
  std::optional<double> radius_mm;
  std::optional<NumberPair> density;
  std::optional<Vec3d> piece_at, rigid_at;
};
/// The keys whose values are numbers alone.
Fields fields(PlacedSelection& given);

/// One key of a handle's path: its shift, turn and scale count from the start of the path; absent
/// ones are interpolated from the other keys.
struct PlacedPose {
  std::string place;
  double time = 0;
  Easing easing = Easing::smooth;
  std::optional<Vec3d> by, by_lps_mm;
  std::optional<double> rotate_deg;
  std::optional<Vec3d> axis;  // of the frame; absent: that of the handle, or of the first pose
  std::optional<double> scale;
  std::optional<Vec3d> scale_axes;
};
Fields fields(PlacedPose& given);
/// `time` and `easing` of a key of any path, of handles or cameras.
Fields key_fields(double& time, Easing& easing);

/// A handle that moves by one of by and by_lps_mm, or a turn or a scale, or along a path, unless
/// its points have displacements of their own.
struct PlacedHandle : PlacedSelection {
  std::optional<Vec3d> by;  // mm along the directions of the frame
  std::optional<Vec3d> by_lps_mm;
  std::optional<double> rotate_deg;
  std::optional<Vec3d> axis, about;  // of the frame
  std::optional<double> scale;
  std::optional<Vec3d> scale_axes;  // per axis of the frame
  std::vector<PlacedPose> path;     // times ascend
};

}  // namespace supple
