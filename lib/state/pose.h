// The present place of the tissue of a state. Pictures, slices and exports find its sources by the
// inverse, or each sample by itself.
#pragma once

#include <functional>

#include "lib/state/state.h"
#include "volumes/base/progress.h"

namespace supple {

/// Extended displacement and its inverse, which renderer and exports read.
struct Pose {
  Displacement displacement;
  OffsetField offsets;
};

/// The inverse of a state's extended displacement; warns of folded cells and unresolved voxels.
/// `wants`: the bricks in which offsets are wanted (InvertParams); of a body with cuts all are.
OffsetField invert_displacement(const State& state, const Displacement& extended,
                                Progress* progress = nullptr,
                                const std::function<bool(const Vec3i& origin)>& wants = {});
/// Returns the extended displacement and its inverse.
Pose invert_state(const State& state, Progress* progress = nullptr);

/// u on the elements alone, without the air around them; null: at rest.
Displacement on_elements(const Geometry& geometry, const BrickTopology& elements,
                         const Displacement* displacement);

/// True if a cut of the body has opened, so that the displacement jumps: samples cannot solve for
/// themselves then.
bool has_open_cuts(const State& state, const Displacement& extended);

}  // namespace supple
