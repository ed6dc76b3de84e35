// Tightening: Enhanced ChainMail under limits that depend on the perpendicular links
// (tight_limits.h; thesis section 4.2.4, the second suggestion for volume conservation).
//
// It follows a drag, or a relaxation, and starts from what that left. The thesis would check
// perpendicular neighbours while a drag spreads, with limits of every link's own that depend on the
// history. Then the result would depend on the processing order, as under ball limits, and
// contradictions would be the rule: tissue that must shorten is joined to bone that must not, which
// is a cycle of negative slack, so there is no least solution to reach. Here instead every
// iteration freezes the limits that follow from the present state, and solves in turn, for all
// three coordinates,
//   1. the links along the axis, chain by chain: every link that is too long or too short for its
//      tightened limits gets the nearest length that they allow, the others keep theirs. A chain
//      moves about a fixed point: its held element, or the place where as many of its
//      elements move one way as the other. Elements between two held ones stay.
//   2. the whole coordinate under the material's limits and all holds: the projection of
//      project.cpp, half-way between the envelopes.
// Chains are paths, so 1 never contradicts itself; 2 is exact. So there is no processing order: the
// bits are the same for any number of threads. A state is measured by a sum of squares over all
// links: of the length by which each misses the limits tightened by that same state. Iterations go
// on while each takes a hundredth of the sum away; one that does not is undone.
//
// Diagonals of a material with 18 or 26 links keep their own limits, in 2.
//
// So three properties hold that ball limits lack: the result is a valid ECM configuration, even
// where tightened limits stay violated; handles, anchors and pushes are as the drag left them; the
// sum of squares never rises. Links that stay violated are counted. They are no error: material and
// holds may leave no room.
//
// Volume follows from the lengths along the axes alone: where shear is strong, or two axes are
// stretched and the third is to make up for both, it is kept in part. A drag alone stretches links
// to the end of their limits, one after the other; tightened after a relaxation, which shares a
// stretch out, a body keeps its volume better and cells their shape. docs/models/volume.md has the
// figures. A later relaxation draws the links back, so tightening comes last.
//
// Cost, measured: 0.4 to 2 us per element that moves, two to three iterations together; about 30 kB
// per brick that moves or lies beside one that does.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/region.h"
#include "lib/chainmail/drag.h"
#include "lib/chainmail/ecm.h"
#include "lib/chainmail/tight_limits.h"
#include "volumes/base/progress.h"

namespace supple {

/// Tightens the body's present state. Elements of `fixed` and those that `held` holds still do not
/// move, those of push handles stay at or beyond where they were pushed to. A start that is not
/// known to be valid (Body::links_known_valid) is checked and projected first, as drag() does.
/// Throws InputError: params out of range, a region without element. The body is unchanged then,
/// but for the projection also when `progress` cancels.
TightenReport tighten(Body& body, const std::vector<Region>& fixed, const Holds& held,
                      const TightenParams& params = {}, Progress* progress = nullptr);

}  // namespace supple
