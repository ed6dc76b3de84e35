// Checks that the functions of sampling paths share.
#pragma once

#include <string>

#include "volumes/base/units.h"
#include "volumes/base/vec.h"

namespace supple {

/// Throws InputError unless the condition holds.
void require_path(bool good, const std::string& field, const std::string& found,
                  const std::string& expected);
void require_finite(const std::string& field, const Vec3d& v);
void require_between(const std::string& field, double value, double lo, double hi,
                     const std::string& unit);
/// The vector at length 1; throws for one without direction.
Vec3d unit_of(const std::string& field, const Vec3d& v);
/// The part of v across a unit vector, at length 1; throws where there is none.
Vec3d unit_across(const std::string& field, const Vec3d& v, const Vec3d& axis,
                  const std::string& expected);
/// v turned about a unit axis by an angle in radians, right-handed.
Vec3d rotated(const Vec3d& v, const Vec3d& axis, double angle);
}  // namespace supple
