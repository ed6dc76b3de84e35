#include "volumes/geometry/geometry.h"

#include <cmath>
#include <sstream>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr double kMinUnitDeterminant = 1e-6;
constexpr double kMaxVoxels = 1099511627776.0;  // 2^40
// Far beyond any grid of matter; the inverse and the 32-bit floats of file formats hold these.
constexpr double kMinAxis = 1e-20, kMaxAxis = 1e20, kMaxOrigin = 1e30;  // mm

template <class Vector>
std::string to_text(const Vector& v) {
  std::ostringstream text;
  text << v.x << " " << v.y << " " << v.z;
  return text.str();
}

void check_dims(const Vec3i& dims) {
  if (dims.x < 1 || dims.y < 1 || dims.z < 1) {
    throw InputError({"", "dims", to_text(dims), "three positive integers"});
  }
  if (double(dims.x) * dims.y * dims.z > kMaxVoxels) {
    throw InputError({"", "dims", to_text(dims), "a product of at most 2^40 voxels"});
  }
}

}  // namespace

Geometry::Geometry() : Geometry({1, 1, 1}, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}}) {}

Geometry::Geometry(const Vec3i& dims, const Vec3d& origin_lps_mm,
                   const std::array<Vec3d, 3>& axes_mm)
    : m_dims(dims), m_origin(origin_lps_mm), m_axes(axes_mm) {
  check_dims(dims);
  if (!is_finite(m_origin) || !(m_origin.length() <= kMaxOrigin)) {
    throw InputError({"", "origin", to_text(m_origin), "three finite numbers, at most 1e30 mm"});
  }
  for (const Vec3d& axis : m_axes) {
    if (!is_finite(axis) || !(axis.length() >= kMinAxis && axis.length() <= kMaxAxis)) {
      throw InputError({"", "spacing and direction", to_text(axis),
                        "finite axes longer than 0 mm, from 1e-20 to 1e20"});
    }
  }
  const auto unit = direction();
  const double unit_determinant = unit[0].dot(unit[1].cross(unit[2]));
  if (!(std::abs(unit_determinant) >= kMinUnitDeterminant)) {
    throw InputError({"", "direction", "axes with determinant " + std::to_string(unit_determinant),
                      "three linearly independent axes"});
  }
  // Rows of the inverse: cross products over the determinant, on unit axes so that extreme
  // spacings neither overflow nor vanish.
  const Vec3d length = spacing_mm();
  m_inverse_rows = {unit[1].cross(unit[2]) / (unit_determinant * length.x),
                    unit[2].cross(unit[0]) / (unit_determinant * length.y),
                    unit[0].cross(unit[1]) / (unit_determinant * length.z)};
}

Vec3d Geometry::spacing_mm() const {
  return {m_axes[0].length(), m_axes[1].length(), m_axes[2].length()};
}

std::array<Vec3d, 3> Geometry::direction() const {
  return {m_axes[0].normalized(), m_axes[1].normalized(), m_axes[2].normalized()};
}

double Geometry::determinant() const {
  return m_axes[0].dot(m_axes[1].cross(m_axes[2]));
}

bool Geometry::is_orthogonal(double tolerance) const {
  const auto unit = direction();
  return std::abs(unit[0].dot(unit[1])) < tolerance && std::abs(unit[1].dot(unit[2])) < tolerance &&
         std::abs(unit[2].dot(unit[0])) < tolerance;
}

long long Geometry::voxel_count() const {
  return static_cast<long long>(m_dims.x) * m_dims.y * m_dims.z;
}

Vec3d Geometry::world_vector_from_index(const Vec3d& step) const {
  return m_axes[0] * step.x + m_axes[1] * step.y + m_axes[2] * step.z;
}

Vec3d Geometry::index_vector_from_world(const Vec3d& vector_mm) const {
  return {m_inverse_rows[0].dot(vector_mm), m_inverse_rows[1].dot(vector_mm),
          m_inverse_rows[2].dot(vector_mm)};
}

Vec3d Geometry::world_from_index(const Vec3d& index) const {
  return m_origin + world_vector_from_index(index);
}

Vec3d Geometry::index_from_world(const Vec3d& world_mm) const {
  return index_vector_from_world(world_mm - m_origin);
}

Vec3d Geometry::world_gradient_from_index(const Vec3d& gradient) const {
  return m_inverse_rows[0] * gradient.x + m_inverse_rows[1] * gradient.y +
         m_inverse_rows[2] * gradient.z;
}

Geometry Geometry::with_dims(const Vec3i& dims) const {
  return {dims, m_origin, m_axes};
}

bool Geometry::operator==(const Geometry& other) const {
  return m_dims == other.m_dims && m_origin == other.m_origin && m_axes == other.m_axes;
}

}  // namespace supple
