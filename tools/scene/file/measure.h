// Distances and angles between places of tissue. They are kept where it was at rest, and follow it:
// a place is now where the displacement has brought it, in the air where that is extended to it.
// Elsewhere in the air it stays. Across an open cut the displacement is interpolated.
#pragma once

#include <string>
#include <vector>

#include "volumes/base/table.h"
#include "volumes/base/value.h"
#include "volumes/field/offset_field.h"

namespace supple::tools {

struct Measure {
  std::string name;           // empty: it has its number alone
  std::vector<Vec3d> points;  // LPS mm at rest; two of a distance, three of an angle at the second

  bool is_angle() const { return points.size() == 3; }
  const char* kind() const { return is_angle() ? "angle" : "distance"; }
  const char* unit() const { return is_angle() ? "degrees" : "mm"; }
};

/// Reads `name` and `points`. Throws InputError for other numbers of points than two and three, and
/// for one beside another in the same place.
Measure read_measure(Table& table);
/// Returns the keys that read_measure() reads.
Value keys_of(const Measure& measure);

/// Returns mm between two points, or the degrees of three at the second one, from 0 to 180.
double measured_value(const std::vector<Vec3d>& points);
/// Returns where a place at rest is now, both in voxels.
Vec3d place_now(const Vec3d& rest_index, const Displacement& moved);
/// Returns the points in LPS mm where the displacement has brought them.
std::vector<Vec3d> points_now(const Measure& measure, const Displacement& moved);

/// Returns a table: `name`, `kind`, `unit`, value `at_rest` and `now`, then the points `x1` to `z3`
/// now and `x1_rest` to `z3_rest` at rest, in LPS mm. A measure without a name has its number; a
/// distance has no third point.
std::string measures_csv(const std::vector<Measure>& measures, const Displacement& moved);

}  // namespace supple::tools
