// Handles and anchors as users write them, on the command line and in scenes: voxels, boxes,
// balls, densities, connected pieces, files of points and labels; shifted, turned and scaled.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "lib/session/step.h"
#include "volumes/geometry/pose_path.h"
#include "volumes/io/point_file.h"

namespace supple {

/// Frames of places: voxels, with directions in millimetres along the grid axes i, j, k; or
/// millimetres in the patient.
enum class PlaceFrame { voxel, lps, ras };

Vec3d index_of(const Vec3d& place, PlaceFrame frame, const Geometry& geometry);
/// A vector of mm.
Vec3d lps_of(const Vec3d& vector_mm, PlaceFrame frame, const Geometry& geometry);

/// Exactly one of box, at_lps_mm, points, label and ball, or none beside density, piece_at or
/// rigid_at, which narrow a box or a ball.
struct GivenSelection {
  std::string place;  // "file:line" of a scene, for errors
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
Fields fields(GivenSelection& given);

/// One of by_mm and by_lps_mm, or a turn or a scale, unless the points have displacements of their
/// own.
struct GivenMotion {
  std::optional<Vec3d> by;  // mm along the directions of the frame
  std::optional<Vec3d> by_lps_mm;
  std::optional<double> rotate_deg;
  std::optional<Vec3d> axis, about;  // of the frame
  std::optional<double> scale;
  std::optional<Vec3d> scale_axes;  // per axis of the frame
  double soft_mm = 0;
  bool push = false;
  bool spares_fixed = false;
  bool slides = false;
};
Fields fields(GivenMotion& given);

/// One key of a handle's path: its shift, turn and scale count from the start of the path; absent
/// ones are interpolated from the other keys.
struct GivenPose {
  std::string place;
  double time = 0;
  Easing easing = Easing::smooth;
  std::optional<Vec3d> by, by_lps_mm;
  std::optional<double> rotate_deg;
  std::optional<Vec3d> axis;  // of the frame; absent: that of the handle, or of the first pose
  std::optional<double> scale;
  std::optional<Vec3d> scale_axes;
};
Fields fields(GivenPose& given);
/// `time` and `easing` of a key of any path, of handles or cameras.
Fields key_fields(double& time, Easing& easing);

struct GivenHandle : GivenSelection, GivenMotion {
  std::vector<GivenPose> path;  // instead of a shift, turn and scale; times ascend

  bool is_animated() const { return !path.empty(); }
};

/// Elements that are chosen together, to move as a rigid piece or to be removed.
struct GivenPart : GivenSelection {
  std::string name;
};
ChosenPart to_part(const GivenPart& given, const Geometry& geometry);

/// The voxels of a voxel or box. In mm, those between the voxels nearest to the corners.
std::optional<IndexBox> box_of(const GivenSelection& given, const Geometry& geometry);

/// The elements that an anchor holds. Throws InputError for a place outside the volume.
Selection to_selection(const GivenSelection& given, const Geometry& geometry);

/// The path on a grid; empty where the handle follows none.
PosePath path_of(const GivenHandle& given, const Geometry& geometry);

/// The handle on a grid: one drag, or one per point with a displacement of its own. A handle that
/// follows a path is taken at its pose at `time`. Throws InputError for places outside the volume
/// and for displacements beyond the range.
std::vector<Drag> to_drags(const GivenHandle& given, const Geometry& geometry, double time);

/// Throws InputError with the line of the first point that lies outside the body, and how far.
void require_in_body(const PointFile& points, const Body& body);

/// The voxels of the points as boxes of one each, without duplicates. Throws InputError for one
/// outside the volume.
std::vector<IndexBox> boxes_of(const PointFile& points, const Geometry& geometry);

}  // namespace supple
