// Steps whose handles follow paths: the poses that such a step is solved at, one after another.
#pragma once

#include <vector>

#include "lib/session/handles.h"

namespace supple {

/// Between two poses of a step no handle turns by more. The chord of such an arc lies within 0.4 %
/// of its radius.
constexpr double kMostTurnDeg = 10;

/// Of the motion's point and frame, at a pose of its path.
DragPose pose_of(const PathPose& pose, HandleMotion motion);

/// What the handles of a step mean on a grid, as to_drags() at the end of their paths, with the
/// poses on the way: those of all keys, and so many between them that shifts stray from straight
/// lines by no more than a quarter of a voxel and turns by no more than kMostTurnDeg at once.
/// Straight ways need none between: ECM gives the same in one drag as in many.
std::vector<Drag> drags_along_paths(const std::vector<GivenHandle>& handles,
                                    const Geometry& geometry);

}  // namespace supple
