// Which nodes and bricks of the output lattice a deformed field can reach; found before the
// inversion proper, so that its memory is the bricks in reach, never a box.
#pragma once

#include <string>

#include "volumes/field/source_cells.h"

namespace supple {

/// Lattice nodes in the box of a deformed cell, relative to its lowest corner. Throws InputError
/// for a cell stretched over more than 2^24 nodes: that is a tear, not a deformation.
IndexBox nodes_of(const CellCorners& corners, const Vec3i& cell);

/// Sorted, unique origins of the output bricks that the cells of u can reach. `still[b]`: all
/// corners of the cells of source brick b have u = 0.
std::vector<Vec3i> output_origins(const VectorBricks& u, const std::vector<std::uint8_t>& still);

void sort_unique(std::vector<Vec3i>& voxels);
std::string to_text(const Vec3i& v);

}  // namespace supple
