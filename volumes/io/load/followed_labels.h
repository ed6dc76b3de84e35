// Labels that follow a deformation: each voxel takes the label nearest to the place that its
// content came from, so that no label appears that was not there before. Cost: 0.1 µs per voxel and
// core through offsets, 2 µs where each is solved for.
#pragma once

#include <atomic>
#include <functional>

#include "volumes/field/offset_field.h"
#include "volumes/field/points/point_motion.h"
#include "volumes/io/load/stored_labels.h"

namespace supple {

/// Writes the stored labels of slice k, i fastest.
using LabelSliceSource = std::function<void(int k, char* out)>;

/// The label at x + o(x) for each voxel x, 0 in the void. Both refer to their arguments.
LabelSliceSource followed_labels(const StoredLabels& labels, const OffsetField& offsets,
                                 const Geometry& grid);
/// The label at the place that the motion leads to; 0 outside of the motion, and at voxels that are
/// unresolved, which are counted.
LabelSliceSource followed_labels(const StoredLabels& labels, const PointMotion& motion,
                                 const Geometry& grid, std::atomic<std::int64_t>& unresolved);

}  // namespace supple
