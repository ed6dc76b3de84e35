// Solution of a step of finite elements (fem_step.h) in the body of a session.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "lib/model/model.h"
#include "lib/session/fem_step.h"
#include "volumes/base/progress.h"

namespace supple {

struct FemResponses;  // lib/session/kept_voxels.h
struct PieceMotion;   // lib/session/handles/rigid_drag.h
struct FreePose;      // lib/session/free_poses.h

/// The part of a session that the solver works on.
struct FemTask {
  HeldBody held;
  const LinkCuts& cuts;  // of the body without what rigid pieces hide
  const DensityGrid& density;
  const BrickValues& labels;
  const std::vector<SlotSet>& gripped;     // whose reactions are wanted
  const std::vector<PieceMotion>& pieces;  // that the handles move
  const FemNodes& nodes;                   // of the step before
  std::shared_ptr<const NodeStart> start;  // of the last picture of this solid, or null
  /// Solutions of steps before, replaced by those after this one.
  std::shared_ptr<const FemResponses>& responses;
  /// Poses at which free pieces are to be held instead, now that the body has moved; the last time
  /// none. Null where pieces may pass through each other.
  std::function<std::vector<FreePose>(bool is_last)> keep_apart;
};

/// Moves the body. Warns of loose islands, of results beyond linear theory and of links beyond
/// their limits. Throws InputError as VoxelFemModel and for loads without element, NotConverged,
/// Cancelled; the body unchanged then.
FemRecord move_by_fem(const FemStep& step, const FemTask& task, const std::vector<Handle>& handles,
                      Progress* progress);

}  // namespace supple
