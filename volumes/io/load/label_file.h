// Label volumes: a segmentation's label of each voxel.
#pragma once

#include <string>

#include "volumes/base/progress.h"
#include "volumes/grid/labels.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

/// The labels of the elements, from any file that open_volume reads; empty when all are 0. The
/// label volume must lie on the elements' grid: the same dims, and every voxel within 1e-3 voxel of
/// its place. Throws InputError: as open_volume, another grid, or a value anywhere that is no
/// integer from 0 to kMaxLabel (names the voxel). Streams; memory as the labels take.
BrickValues read_labels(const std::string& path, const Geometry& geometry,
                        const BrickTopology& elements, Progress* progress = nullptr);
BrickValues read_labels(VolumeFile& file, const Geometry& geometry, const BrickTopology& elements,
                        Progress* progress = nullptr);

/// Throws InputError for a volume that does not lie on the grid: other dims, or a voxel more than
/// 1e-3 voxel from its place.
void require_grid(const VolumeHeader& header, const Geometry& geometry);

/// Names that a file gives its labels; empty where it gives none, or is not there. Reads a header.
LabelNames label_names(const std::string& path);

}  // namespace supple
