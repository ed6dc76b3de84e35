// The files that a scene writes beside its pictures: [output].
#pragma once

#include <string>
#include <vector>

#include "lib/fem/voxel/fem_results.h"
#include "volumes/base/table.h"

namespace supple::tools {

/// A volume of what a step of finite elements says of its elements.
struct ElementOutput {
  FemQuantity quantity;
  std::string path;
  std::string table;  // in which it stands, as errors call it
};

struct SceneOutput {
  std::string state;
  bool refers = false;  // the state to its volume, in place of holding what did not move
  std::vector<std::string> offsets;        // resample-direction warps
  std::vector<std::string> displacements;  // material-direction warps
  std::vector<std::string> volumes;        // resampled volumes
  std::vector<ElementOutput> elements;     // of the last step of finite elements
  std::string forces;                      // a table (.csv) of forces on handles and shapes by step
  std::string motion;                      // a table (.csv) of the last step with a motion in time

  std::vector<std::string> all() const;
};

/// Throws InputError as Table.
SceneOutput read_output(Table& table);

}  // namespace supple::tools
