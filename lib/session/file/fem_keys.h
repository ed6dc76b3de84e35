// The keys of `fem = { … }` in a step of a scene, with its loads `forces`, `pressures` and
// `swellings`.
#pragma once

#include "lib/session/fem_step.h"
#include "volumes/base/table.h"
#include "volumes/io/load/label_file.h"

namespace supple {

/// Throws InputError as Table, and for loads that name no elements.
FemStep read_fem(Table& table, const LabelNames& names);
/// Reads `directions`, at most twelve; without the key none.
std::vector<HandDirection> read_directions(Table& table);
/// Reads the loads alone.
void read_loads(Table& table, const LabelNames& names, FemStep& fem);

}  // namespace supple
