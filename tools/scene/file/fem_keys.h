// The keys of `fem = { … }` in a step of a scene, with its loads `forces`, `pressures` and
// `swellings`.
#pragma once

#include "lib/session/fem_step.h"
#include "lib/session/handles.h"
#include "volumes/base/table.h"
#include "volumes/io/load/label_file.h"

namespace supple::tools {

/// A load whose elements are not yet found on a grid.
struct GivenLoad : FemLoad {
  GivenPart given;
};

struct GivenFem {
  FemStep step;
  std::vector<GivenLoad> loads;
};

/// Throws InputError as Table, and for loads that name no elements.
GivenFem read_fem(Table& table, const LabelNames& names);
/// On a grid.
FemStep fem_step(const GivenFem& given, const Geometry& geometry);

}  // namespace supple::tools
