// Surfaces of the labels of a segmentation: one closed mesh per label, by surface nets (S. Gibson,
// Constrained elastic surface nets, MICCAI 1998). Every cube of eight voxels that are not all
// alike has one vertex; vertices move to the middle of their neighbours, over and over, and never
// leave their cube, so that the surface is smooth and no voxel's centre changes sides.
// Cost: two slices of the grid, about 150 bytes per voxel face between labels, one look-up per
// voxel.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "volumes/geometry/geometry.h"
#include "volumes/io/mesh/triangle_mesh.h"

namespace supple {

struct LabelSurface {
  std::int64_t label;
  TriangleMesh mesh;  // counter-clockwise from outside
};

/// Surfaces in ascending order of labels; 0 is no label. `label_at`: of a voxel of the grid.
std::vector<LabelSurface> label_surfaces(
    const Geometry& geometry, const std::function<std::int64_t(const Vec3i& voxel)>& label_at);

}  // namespace supple
