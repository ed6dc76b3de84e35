// How deep rigid pieces lie in each other: the judge of their contact, which shares nothing with
// it.
//
// Every element of a piece counts, where its offset puts it. The motion of another piece is fitted
// to the offsets of its elements and taken back from there, and unit cubes around voxels at rest
// are compared. Cost: about 1 us per element and piece within whose box it is, and 0.2 us to know.
#pragma once

#include "lib/body/body.h"

namespace supple {

/// The deepest overlap of voxels of two pieces, in voxels; 0 where none overlap.
double deepest_overlap(const Body& body);

}  // namespace supple
