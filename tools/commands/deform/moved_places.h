// Points of files sent through a motion, and their outcomes for warnings and reports.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/console/console.h"
#include "volumes/base/value.h"
#include "volumes/field/points/point_motion.h"

namespace supple::tools {

/// Entries of one kind that a report with --json lists at most.
constexpr std::size_t kListed = 1000;

struct MovedPlaces {
  std::vector<MovedPoint> points;  // one per point given
  std::int64_t outside = 0, folded = 0, torn = 0, unresolved = 0;

  std::vector<Vec3d> positions() const;
};

/// Moves all points, in the stage "moving" of the console.
MovedPlaces move_all(const PointMotion& motion, const std::vector<Vec3d>& points_lps_mm,
                     Console& console);

/// Says how many points are outside, folded, torn and unresolved; `name` tells where point n stands
/// in the file. `is_warp`: points outside stay where they are.
void warn_of(const MovedPlaces& moved, bool is_warp,
             const std::function<std::string(std::size_t)>& name, Console& console);

/// The report of `apply` about points with --json; at most `kListed` of each kind are listed
/// by their numbers from 0.
Value to_value(const MovedPlaces& moved);

}  // namespace supple::tools
