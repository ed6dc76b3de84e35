// The keys of `tets = { … }` in a step of a scene, with its loads, `openings` and `sheets`.
#pragma once

#include "lib/session/fem_step.h"
#include "volumes/base/table.h"
#include "volumes/grid/labels.h"

namespace supple {

/// Throws InputError as Table, for an opening without a place and for a sheet on no faces.
FemStep read_tets(Table& table, const LabelNames& names);

}  // namespace supple
