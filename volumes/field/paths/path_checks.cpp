#include "volumes/field/paths/path_checks.h"

#include <cmath>

#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

void require_path(bool good, const std::string& field, const std::string& found,
                  const std::string& expected) {
  if (!good) throw InputError({"", field, found, expected});
}

void require_finite(const std::string& field, const Vec3d& v) {
  require_path(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z), field, to_text(v),
               "three finite numbers");
}

void require_between(const std::string& field, double value, double lo, double hi,
                     const std::string& unit) {
  require_path(value >= lo && value <= hi, field, number_text(value) + " " + unit,
               number_text(lo) + " to " + number_text(hi) + " " + unit);
}

Vec3d unit_of(const std::string& field, const Vec3d& v) {
  require_finite(field, v);
  require_path(v.length() > 0, field, "a vector of length 0", "a direction");
  return v.normalized();
}

Vec3d unit_across(const std::string& field, const Vec3d& v, const Vec3d& axis,
                  const std::string& expected) {
  require_finite(field, v);
  const Vec3d across = v - axis * v.dot(axis);
  require_path(across.length() > 1e-6 * v.length(), field, to_text(v), expected);
  return across.normalized();
}

Vec3d rotated(const Vec3d& v, const Vec3d& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return v * c + axis.cross(v) * s + axis * (axis.dot(v) * (1 - c));
}

}  // namespace supple
