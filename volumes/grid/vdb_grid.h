// OpenVDB with a way to make grids that compiles none of their virtual functions: those are in its
// library, and instantiating them takes eight seconds for each type of grid.
#pragma once

#include <memory>

#include <openvdb/openvdb.h>

namespace supple {

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

}  // namespace supple
