// The OpenVDB side of DensityGrid. Heavy: include only where grids are created, read or written.
#pragma once

#include <memory>

#include <openvdb/openvdb.h>

#include "volumes/grid/density_grid.h"

namespace supple {

// Grids are made without compiling their virtual functions: those are in OpenVDB's library, and
// instantiating them takes eight seconds for each type of grid.

using FloatLeaf = openvdb::FloatTree::LeafNodeType;

/// openvdb::initialize(), without its messages on stderr.
void initialize_vdb();

/// An empty grid of a type that OpenVDB registers, in place of Grid::create(background).
template <class Grid>
typename Grid::Ptr make_grid(const typename Grid::ValueType& background) {
  initialize_vdb();
  auto grid = std::static_pointer_cast<Grid>(openvdb::GridBase::createGrid(Grid::gridType()));
  grid->tree().root().setBackground(background, false);
  return grid;
}

struct DensityGrid::Vdb {
  openvdb::FloatGrid::ConstPtr grid;
};

/// The grid itself, in index space, shared and never changed: active voxels are the bricks'.
inline openvdb::FloatGrid::ConstPtr vdb_grid(const DensityGrid& density) {
  return density.vdb().grid;
}

}  // namespace supple
