// The OpenVDB side of DensityGrid. Heavy: include only where grids are created, read or written.
#pragma once

#include <openvdb/openvdb.h>

#include "volumes/grid/density_grid.h"

namespace supple {

struct DensityGrid::Vdb {
  openvdb::FloatGrid::ConstPtr grid;
};

}  // namespace supple
