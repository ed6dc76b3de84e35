// Overlap of two segmentations, label by label.
//
// Dice (Ecology 26, 1945): 2 |A and B| / (|A| + |B|), of the voxels of a grid that have the label
// in A and in B. Cost: one look-up of each segmentation per voxel.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>

#include "volumes/base/progress.h"
#include "volumes/geometry/geometry.h"

namespace supple {

/// The label at a place in LPS mm; 0 for none. May be asked by several threads at once.
using LabelLookup = std::function<double(const Vec3d& lps_mm)>;

/// Voxels that have one label.
struct LabelOverlap {
  std::int64_t in_a = 0, in_b = 0, in_both = 0;

  double dice() const { return 2 * double(in_both) / double(in_a + in_b); }
};

/// Every label other than 0 of either segmentation.
using LabelOverlaps = std::map<double, LabelOverlap>;

/// Compares labels; `mask`: only voxels where it is not 0. Throws Cancelled.
LabelOverlaps compare_labels(const Geometry& grid, const LabelLookup& a, const LabelLookup& b,
                             const LabelLookup& mask = {}, Progress* progress = nullptr);

/// The mean over the labels; nothing where there are none.
std::optional<double> mean_dice(const LabelOverlaps& overlaps);

}  // namespace supple
