// The part of a state that refers to a source which the state holds by itself: the bricks in which
// something moved, was cut or was removed, those that tissue went to, and their neighbours, so that
// what moved can be read without the source.
#pragma once

#include "lib/state/state_source.h"
#include "volumes/field/offset_field.h"

namespace supple {

/// `displacement`: extended over the shell; `offsets`: its inverse, or null.
/// Cost: one pass over the bricks, and 27 look-ups for each that is the state's own.
BrickIndex own_bricks(const State& state, const VectorBricks& displacement,
                      const VectorBricks* offsets);

/// Return the part in these bricks alone; of vectors also that where some is not 0.
BrickTopology part_of(const BrickTopology& bricks, const BrickIndex& own);
DensityGrid part_of(const DensityGrid& density, const BrickIndex& own);
VectorBricks part_of(const VectorBricks& field, const BrickIndex& own);

/// Adds the bricks of an open source to a state that holds its own ones alone. Where these are as
/// the source gives them, densities and elements are shared with it.
void complete(State& state, const StateSource& source, const BrickIndex& own);

}  // namespace supple
