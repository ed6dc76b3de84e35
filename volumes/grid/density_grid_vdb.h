// The OpenVDB side of DensityGrid. Heavy: include only where grids are created, read or written.
#pragma once

#include "volumes/grid/density_grid.h"
#include "volumes/grid/vdb_trees.h"

namespace supple {

struct DensityGrid::Vdb {
  openvdb::FloatGrid::ConstPtr grid;
};

}  // namespace supple
