// A handle of a step with its motion, as it was placed or on the grid.
#pragma once

#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "lib/session/handles/selection.h"

namespace supple {

/// Handles follow their paths from the first key to the last.
constexpr double kWholePaths = std::numeric_limits<double>::infinity();

/// Scale, then turn, both about one point and in mm, so that unequal spacings keep shapes; the
/// shift comes after.
struct HandleMotion {
  std::optional<Vec3d> about_lps_mm;  // absent: the middle of the grabbed elements
  Vec3d axis_lps{0, 0, 1};            // of any length but 0
  double angle_deg = 0;               // right-handed about the axis
  Vec3d scale{1, 1, 1};
  bool scales_along_grid = false;  // scale is along i, j, k, not x, y, z

  bool is_shift() const { return angle_deg == 0 && scale == Vec3d(1); }
};

/// Motion on which a drag takes its elements, from where they are before the step.
struct DragPose {
  Vec3d by_mm;
  HandleMotion motion;
};

/// Programs give region or selection and motion on the grid; files and the command line give
/// `placed`, which on_grid() of handles.h turns into these.
struct Drag {
  Region region = Vec3i(0);
  Vec3d by_mm{0, 0, 0};    // along the grid axes
  std::int32_t label = 0;  // whose elements are grabbed, as one, instead of the region
  std::optional<Selection> selection = {};  // grabbed instead of the region
  HandleMotion motion = {};
  /// Poses to pass through before the motion above; as many in every drag of a step that has any.
  std::vector<DragPose> way = {};
  std::optional<PlacedHandle> placed = {};  // all of the above before it is on the grid
  double soft_mm = 0;   // width of an edge around a selected box or ball, which follows in part
  bool pushes = false;  // moves tissue ahead of it and never back, instead of holding it
  bool spares_fixed = false;  // leaves out what anchors hold, whole rigid pieces too
  /// A shift that something stops goes on along each axis of the grid as far as that is free.
  bool slides = false;

  bool is_animated() const { return placed && !placed->path.empty(); }
};
/// The elements of one handle, at rest.
struct HandlePlace {
  std::string name;  // of its region
  std::int64_t elements = 0;
  Vec3d centre_index{0, 0, 0}, centre_lps_mm{0, 0, 0};
  float least_density = 0, largest_density = 0;
  std::set<std::int32_t> labels;  // 0: some have none
};

/// The keys of a motion; `placed` must be there.
Fields fields(Drag& handle);

}  // namespace supple
