// The map of landmarks with the least stiffness that folds no cell of a grid.
#pragma once

#include "volumes/base/progress.h"
#include "volumes/field/landmarks/landmark_map.h"

namespace supple {

struct UnfoldedMap {
  LandmarkMap map;
  double stiffness_mm = 0;  // within 5 % above the least one, or as it was asked for
};

/// Tries stiffnesses from `stiffness_mm` up to 1000 times the extent of the landmarks, at which a
/// spline is affine but for a thousandth. Throws InputError where even that one folds; Cancelled.
/// Cost: LandmarkMap::slices and GridFolds some 12 times where anything folds, else once.
UnfoldedMap without_folds(const Landmarks& landmarks,
                          const std::shared_ptr<const RigidRegions>& regions, double stiffness_mm,
                          const Geometry& grid, const Progress* progress);

}  // namespace supple
