// The offsets that relaxation works on: q and its fraction together, in 2^-32 voxel, whole numbers
// in doubles.
#pragma once

#include <vector>

#include "lib/body/body.h"
#include "lib/body/region.h"
#include "lib/body/slot_set.h"
#include "lib/relax/link_table.h"

namespace supple {

/// Offsets of the table's coordinate. A fraction counts unless a link or a bound would not hold
/// with it, as where another model has moved the other end since; then both ends of the link lose
/// theirs. So a body that is valid gives offsets that are.
BrickArray<double> fine_offsets(const Body& body, const LinkTable& table, const Holds& held);

/// Splits offsets into q, half rounded up and clamped to its range, which keeps every link as valid
/// as it was, and fractions. Bricks that stay at rest are not stored.
void store_fine(const BrickArray<double>& fine, int coordinate, Body& body);

}  // namespace supple
