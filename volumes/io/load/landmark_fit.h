// Settings of a warp through landmarks (volumes/field/landmarks), with rigid regions from a label
// volume: for programs and scripts alike.
#pragma once

#include <string>
#include <vector>

#include "volumes/base/fields.h"
#include "volumes/base/progress.h"
#include "volumes/field/dense/warp.h"
#include "volumes/field/landmarks/grid_folds.h"
#include "volumes/field/landmarks/unfolded_map.h"

namespace supple {

struct LandmarkFit {
  WarpDirection direction = WarpDirection::resample;
  double stiffness_mm = 0, width_mm = 10;
  bool has_no_folds = false;
  std::string labels;      // a file; with `rigid` alone
  std::vector<int> rigid;  // labels, without a field
};
Fields fields(LandmarkFit& settings);

/// The map that leads from landmarks to their partners, LPS mm, or back where the direction is
/// resample; `grid` is that in which nothing shall fold. Throws UsageError for labels without
/// rigid ones and the other way, InputError as LandmarkMap, RigidRegions and without_folds, and for
/// another count of partners; Cancelled.
UnfoldedMap fit_landmarks(const LandmarkFit& settings, const std::vector<Vec3d>& from,
                          const std::vector<Vec3d>& to, const Geometry& grid, Progress* progress);

/// Report of a map whose vectors were counted on their grid: stiffness, misfits in mm, folds.
Value to_value(const UnfoldedMap& found, const GridFolds& folds);

}  // namespace supple
