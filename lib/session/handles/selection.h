// Elements selected by place at rest, by density and by connection, for handles and anchors beside
// boxes, points and labels; first as people write them, in one of three frames, then on the grid.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lib/body/region.h"
#include "volumes/base/fields.h"
#include "volumes/base/value.h"
#include "volumes/geometry/keyframes.h"
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

/// Each member that is given narrows the body further, in this order: a box, a ball, a range of
/// densities, the rigid piece that holds a voxel, and the face-connected piece of the rest that
/// holds a voxel. Cuts do not part face-connected pieces.
struct Selection {
  std::optional<IndexBox> box;
  std::optional<Vec3d> ball_index;  // centre in voxels
  double radius_mm = 0;
  std::optional<NumberPair> density;  // both ends belong to it
  std::optional<Vec3i> piece_at;
  std::optional<Vec3i> rigid_at;  // the rigid piece that holds a voxel

  bool operator==(const Selection& other) const;
  /// Text of the command line: "ball:128,211,12:8", "density:300:3100", "piece:128,211,12".
  std::string name() const;
};

/// Throws InputError, named `role` ("grab", "fix"), when there is no such element, and for a piece
/// at a voxel that is none of them. Cost: a pass over the elements.
Region region_of(const Selection& selection, const Body& body, const DensityGrid& density,
                 const std::string& role);

/// Distance of a voxel outside the selection's ball; negative inside.
double beyond_ball_mm(const Selection& selection, const Geometry& geometry, const Vec3i& voxel);

/// All elements of a label or of a selection, connected or not, under a name.
struct ChosenPart {
  ChosenPart() = default;
  ChosenPart(const IndexBox& box) { selection.emplace().box = box; }
  ChosenPart(const Vec3i& lo, const Vec3i& hi) : ChosenPart(IndexBox{lo, hi}) {}

  std::string name;  // empty: as the selection
  std::int32_t label = 0;
  std::optional<Selection> selection = {};
  std::optional<PlacedSelection> placed = {};  // label and selection before they are on the grid

  std::string title() const;
  /// The box where it alone is selected; else null.
  const IndexBox* box() const;
};

/// Throws InputError, named `role`, as region_of(), and for a label that no element has.
SlotSet elements_of(const ChosenPart& part, const Body& body, const DensityGrid& density,
                    const BrickValues& labels, const std::string& role);
/// Returns the part as a journal records it.
Value chosen_value(const ChosenPart& part);

/// Elements around a box or ball and how much of its motion each takes.
struct SoftEdge {
  SlotSet slots;
  std::vector<double> parts;  // 0 to 1, in the order of the slots
};

/// The elements of the selection's densities outside its box or ball, nearer to it than `width_mm`,
/// that none of these cuts parts from it: the links along the straight way to it are whole.
/// The part falls from 1 to 0 with slope 0 at both ends: 1 - t^2 (3 - 2 t) at distance t width_mm.
SoftEdge soft_edge(const Selection& selection, double width_mm, const Body& body,
                   const LinkCuts& cuts, const DensityGrid& density);

/// Returns the selection as a journal records it, and a state its anchors.
Value selection_value(const Selection& selection);
/// Reads it back. Throws InputError naming `file`.
Selection selection_of(const Value& value, const std::string& file);

}  // namespace supple
