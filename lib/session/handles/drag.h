// A handle of a step with its motion, as it was placed or on the grid.
#pragma once

#include <optional>
#include <vector>

#include "lib/session/handles/handle_motion.h"
#include "lib/session/handles/selection.h"

namespace supple {

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
/// The keys of a motion; `placed` must be there.
Fields fields(Drag& handle);

}  // namespace supple
