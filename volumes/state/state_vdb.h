// The grids of a state file that make the state, as OpenVDB reads them. The derived ones, which
// come last, are three quarters of the values of a dragged body and are not read at all: io::Stream
// would decode every grid of a file.
#pragma once

#include <string>

#include <openvdb/openvdb.h>

namespace supple {

/// Names of the grids that are derived from the others, for other programs.
constexpr const char* kDisplacementGrid = "displacement";
constexpr const char* kOffsetGrid = "offset";

/// What a stream holds.
struct StateContent {
  openvdb::GridPtrVec grids;  // those before the first derived one
  openvdb::MetaMap metadata;
};

/// Throws InputError with OpenVDB's message clamped; SystemError: not enough memory.
StateContent read_state_grids(const std::string& path);

}  // namespace supple
