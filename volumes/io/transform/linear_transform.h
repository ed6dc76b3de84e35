// The linear transforms of ITK and elastix as affine maps of world points.
#pragma once

#include <string>
#include <vector>

#include "volumes/geometry/geometry.h"

namespace supple {

/// An affine map of LPS mm: world_from_index applies it, index_from_world its inverse.
using AffineMap = Geometry;

/// An ITK transform as its file holds it.
struct ItkTransform {
  std::string file, group;  // for errors; the group of an HDF5 file
  std::string name;         // without "_double_3_3"
  std::vector<double> fixed, parameters;
};

/// first, then second.
AffineMap composed(const AffineMap& second, const AffineMap& first);

/// Identity, translation, affine, rotations about axes or by a versor, similarity, each about its
/// centre: y = M (x - c) + c + t. Throws InputError for every other transform and wrong counts of
/// parameters.
AffineMap linear_map(const ItkTransform& transform);

}  // namespace supple
