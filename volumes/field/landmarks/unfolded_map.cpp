#include "volumes/field/landmarks/unfolded_map.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/field/landmarks/grid_folds.h"

namespace supple {

namespace {

double extent_of(const std::vector<Vec3d>& points) {
  Vec3d lo = points.front(), hi = lo;
  for (const Vec3d& point : points) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], point[a]);
      hi[a] = std::max(hi[a], point[a]);
    }
  }
  return std::max((hi - lo).length(), 1.0);
}

}  // namespace

UnfoldedMap without_folds(const Landmarks& landmarks,
                          const std::shared_ptr<const RigidRegions>& regions, double stiffness_mm,
                          const Geometry& grid, const Progress* progress) {
  const auto map_with = [&](double stiffness) {
    return LandmarkMap(landmarks, regions, stiffness);
  };
  const auto folds = [&](const LandmarkMap& map) {
    return folds_of(grid, map.slices(grid), progress, 1).folded_cells() > 0;
  };
  LandmarkMap first = map_with(stiffness_mm);
  if (!folds(first)) return {std::move(first), stiffness_mm};

  const double most = 1000 * extent_of(landmarks.points);
  double high = std::max(stiffness_mm * 2, most * 1e-6), low = stiffness_mm;
  LandmarkMap found = map_with(high);
  while (folds(found)) {
    if (high >= most) {
      const std::int64_t left = folds_of(grid, found.slices(grid), progress).folded_cells();
      throw InputError({"", "landmarks", std::to_string(left) + " folded cells at any stiffness",
                        "a motion without folds"});
    }
    low = high;
    high = std::min(high * 8, most);
    found = map_with(high);
  }
  constexpr double kCloseEnough = 1.05;
  while (high > kCloseEnough * low) {
    const double middle = low > 0 ? std::sqrt(low * high) : high / 8;
    LandmarkMap tried = map_with(middle);
    if (folds(tried)) {
      low = middle;
    } else if (low == 0 && middle < most * 1e-9) {
      return {std::move(tried), middle};
    } else {
      found = std::move(tried);
      high = middle;
    }
  }
  return {std::move(found), high};
}

}  // namespace supple
