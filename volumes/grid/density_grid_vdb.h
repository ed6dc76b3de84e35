// The OpenVDB side of DensityGrid. Heavy: include only where grids are created, read or written.
#pragma once

#include "volumes/grid/density_grid.h"
#include "volumes/grid/vdb_grid.h"

namespace supple {

struct DensityGrid::Vdb {
  openvdb::FloatGrid::ConstPtr grid;
};

/// The grid itself, in index space, shared and never changed: active voxels are the bricks'.
inline openvdb::FloatGrid::ConstPtr vdb_grid(const DensityGrid& density) {
  return density.vdb().grid;
}

}  // namespace supple
