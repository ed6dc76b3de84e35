// Elements that handles grab, described for people: their place at rest, densities and labels; and
// messages that say why a place has no element.
#pragma once

#include <set>
#include <string>

#include "lib/body/region.h"
#include "lib/session/handles/drag.h"
#include "lib/state/state.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

/// Throws InputError as elements_of().
HandlePlace place_of(const Region& region, const Body& body, const State& state);

/// Place where a volume's densities can be read once more.
struct DensitySource {
  std::string path;  // empty: nowhere
  ReadOptions read;
};

/// Throws InputError for a single voxel that is no element; it says the density there, and which
/// are elements. Cost where it throws: reading the file up to the voxel's slice.
void require_element(const Region& region, const std::string& role, const Body& body,
                     const State& state, const DensitySource& source);

}  // namespace supple
