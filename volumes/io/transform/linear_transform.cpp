#include "volumes/io/transform/linear_transform.h"

#include <cmath>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"

namespace supple {

namespace {

using MatrixColumns = std::array<Vec3d, 3>;

const MatrixColumns kIdentity = {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}};

Vec3d applied(const MatrixColumns& matrix, const Vec3d& v) {
  return matrix[0] * v.x + matrix[1] * v.y + matrix[2] * v.z;
}

MatrixColumns product(const MatrixColumns& left, const MatrixColumns& right) {
  return {applied(left, right[0]), applied(left, right[1]), applied(left, right[2])};
}

/// Right-handed rotation about a coordinate axis.
MatrixColumns rotation(int axis, double angle) {
  const int second = (axis + 1) % 3, third = (axis + 2) % 3;
  MatrixColumns columns = kIdentity;
  columns[std::size_t(second)][second] = std::cos(angle);
  columns[std::size_t(second)][third] = std::sin(angle);
  columns[std::size_t(third)][second] = -std::sin(angle);
  columns[std::size_t(third)][third] = std::cos(angle);
  return columns;
}

[[noreturn]] void fail(const ItkTransform& transform, const std::string& field,
                       const std::string& found, const std::string& expected) {
  const std::string group = transform.group.empty() ? "" : transform.group + "/";
  throw InputError({transform.file, group + field, found, expected});
}

/// The rotation of a versor given by its vector part (itk::Versor::GetMatrix).
MatrixColumns versor_rotation(const ItkTransform& transform) {
  const double x = transform.parameters[0], y = transform.parameters[1];
  const double z = transform.parameters[2], square = x * x + y * y + z * z;
  if (!(square <= 1 + 1e-9)) fail(transform, "TransformParameters", "no versor", "a versor");
  const double w = std::sqrt(std::max(0.0, 1 - square));
  return {Vec3d(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)),
          {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
          {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}};
}

/// Rz Rx Ry, or Rz Ry Rx where the fourth fixed parameter says so (itk::Euler3DTransform).
MatrixColumns euler_rotation(const ItkTransform& transform) {
  const std::vector<double>& angles = transform.parameters;
  const MatrixColumns x = rotation(0, angles[0]), y = rotation(1, angles[1]),
                      z = rotation(2, angles[2]);
  const bool is_zyx = transform.fixed.size() > 3 && transform.fixed[3] != 0;
  return product(z, is_zyx ? product(y, x) : product(x, y));
}

void require_parameters(const ItkTransform& transform, std::size_t count) {
  if (transform.parameters.size() == count) return;
  fail(transform, "TransformParameters", std::to_string(transform.parameters.size()) + " numbers",
       std::to_string(count) + " for " + transform.name);
}

/// y = M (x - c) + c + t.
AffineMap about_centre(const ItkTransform& transform, const MatrixColumns& matrix,
                       std::size_t shift_at) {
  Vec3d centre(0, 0, 0), shift;
  if (!transform.fixed.empty() && transform.fixed.size() < 3) {
    fail(transform, "TransformFixedParameters", std::to_string(transform.fixed.size()) + " numbers",
         "3 coordinates of the centre");
  }
  for (int c = 0; c < 3; ++c) {
    shift[c] = transform.parameters[shift_at + std::size_t(c)];
    if (!transform.fixed.empty()) centre[c] = transform.fixed[std::size_t(c)];
  }
  return make_geometry(transform.file, {1, 1, 1}, centre + shift - applied(matrix, centre), matrix);
}

}  // namespace

AffineMap composed(const AffineMap& second, const AffineMap& first) {
  MatrixColumns axes = first.axes_mm();
  for (Vec3d& axis : axes) axis = second.world_vector_from_index(axis);
  return {first.dims(), second.world_from_index(first.origin_lps_mm()), axes};
}

AffineMap linear_map(const ItkTransform& transform) {
  const std::string& name = transform.name;
  const std::vector<double>& values = transform.parameters;
  if (name == "IdentityTransform") return {};
  if (name == "TranslationTransform") {
    require_parameters(transform, 3);
    return make_geometry(transform.file, {1, 1, 1}, {values[0], values[1], values[2]}, kIdentity);
  }
  if (name == "AffineTransform" || name == "MatrixOffsetTransformBase") {
    require_parameters(transform, 12);
    return about_centre(transform,
                        {Vec3d(values[0], values[3], values[6]),
                         {values[1], values[4], values[7]},
                         {values[2], values[5], values[8]}},
                        9);
  }
  if (name == "Euler3DTransform") {
    require_parameters(transform, 6);
    return about_centre(transform, euler_rotation(transform), 3);
  }
  if (name == "VersorRigid3DTransform") {
    require_parameters(transform, 6);
    return about_centre(transform, versor_rotation(transform), 3);
  }
  if (name == "Similarity3DTransform") {
    require_parameters(transform, 7);
    MatrixColumns matrix = versor_rotation(transform);
    for (Vec3d& column : matrix) column *= values[6];
    return about_centre(transform, matrix, 3);
  }
  fail(transform, "TransformType", printable(name),
       "a displacement field and linear transforms (identity, translation, affine, Euler, versor, "
       "similarity)");
}

}  // namespace supple
