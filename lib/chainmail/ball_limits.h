// Enhanced ChainMail with ball limits (thesis section 4.2.4, eq. 4.6, figures 4.17 to 4.19): the
// Euclidean length of every link stays in [min_length h, max_length h]. A candidate that violates
// this moves along the straight line to its sponsor onto the nearest allowed length.
//
// The coordinates are not independent any more, and the result DEPENDS ON THE PROCESSING ORDER
// (figure 4.18; a test shows two orders that end apart). So the order is fixed: the largest
// violation in mm first, among equal ones the candidate with the lower slot, then the sponsor with
// the lower slot. One thread computes it in double precision, without any source of chance. There
// is no least solution either: neighbours push each other back and forth. So the number of moves is
// capped, and violations that are left are counted. A length has no side: a handle that jumps past
// its neighbour turns the link round. Large drags are therefore better given in parts of less than
// a voxel. `drag()` of ecm.h has none of these defects and is the default.
//
// Cost, measured: 0.2 to 1.3 us per move (a heap of links), 1 to 14 moves per element that moves,
// so 0.2 to 15 us per element, 5 to 1000 times that of drag(); 14 kB per brick touched.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/region.h"
#include "lib/chainmail/drag.h"
#include "lib/chainmail/ecm.h"
#include "volumes/base/progress.h"

namespace supple {

/// Moves the handles by the whole and lets the body follow. Elements of handles and anchors never
/// move as candidates: a link from a moved element to one of them moves the element back. Handles
/// and anchors that contradict each other are no error here: the report counts the links that they
/// tear. Links that are violated from the start move only when they meet one that moves. Offsets
/// are rounded to 2^-16 voxel at the end; cut links are absent. Body::links_known_valid is false
/// afterwards, as the box limits need not hold, and the next drag() projects. Throws InputError: a
/// region without element, a voxel held twice, a push handle, an offset beyond the range. The body
/// is unchanged then, also when `progress` cancels.
BallReport drag_ball(Body& body, const std::vector<Handle>& handles,
                     const std::vector<Region>& anchors, const BallParams& params = {},
                     Progress* progress = nullptr);

/// The same among the elements that earlier drags hold; these handles are held too. Push handles
/// that are still held are an InputError.
BallReport drag_ball(Body& body, const std::vector<Handle>& handles,
                     const std::vector<Region>& anchors, Holds& holds, const BallParams& params,
                     Progress* progress = nullptr);

}  // namespace supple
