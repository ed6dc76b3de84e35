// OpenVDB with the two kinds of grid that we hold instantiated once, in vdb_trees.cpp: else every
// file that makes a grid compiles all of its virtual functions, for half a minute.
#pragma once

#include <openvdb/openvdb.h>

namespace supple {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;

}  // namespace supple

extern template class openvdb::tree::Tree<openvdb::FloatTree::RootNodeType>;
extern template class openvdb::tree::Tree<openvdb::Vec3STree::RootNodeType>;
extern template class openvdb::Grid<openvdb::FloatTree>;
extern template class openvdb::Grid<openvdb::Vec3STree>;
