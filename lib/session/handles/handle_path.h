// Steps whose handles follow paths: the poses that such a step is solved at, one after another.
#pragma once

#include <vector>

#include "lib/session/handles/handles.h"
#include "volumes/geometry/pose_path.h"

namespace supple {

/// Between two poses of a step no handle turns by more. The chord of such an arc lies within 0.4 %
/// of its radius.
constexpr double kMostTurnDeg = 10;

/// Returns the motion's point and frame at a pose of its path.
DragPose pose_of(const PathPose& pose, HandleMotion motion);

/// The handles of a step on a grid, as to_drags() at the end of their paths, with the poses on the
/// way: those of all keys, and as many between them as keep shifts within a quarter of a voxel of
/// straight lines and turns within kMostTurnDeg each. Straight ways need none between: ECM gives
/// the same in one drag as in many.
std::vector<Drag> drags_along_paths(const std::vector<Drag>& handles, const Geometry& geometry);

}  // namespace supple
