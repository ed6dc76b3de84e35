#include "volumes/field/inversion/linked_elements.h"

#include "volumes/field/inversion/deformed_cell.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

Vec3i step_along(int axis, int side) {
  Vec3i step(0);
  step[axis] = side;
  return step;
}

}  // namespace

Vec3d LinkedElements::at(const Vec3i& voxel) const {
  Vec3f vector(0);
  m_u.at(voxel, vector);
  return Vec3d(vector);
}

bool LinkedElements::is_linked(const Vec3i& voxel, int axis) const {
  const std::int32_t b = m_elements.find(voxel);
  return b >= 0 && mask_test(m_elements.mask(b), brick_offset(voxel)) &&
         m_elements.is_active(voxel + step_along(axis, 1)) &&
         !m_cuts.is_cut(b, brick_offset(voxel), axis);
}

bool LinkedElements::is_linked_to_side(const Vec3i& voxel, int axis, int side) const {
  return is_linked(side < 0 ? voxel + step_along(axis, -1) : voxel, axis);
}

Vec3d LinkedElements::derivative(const Vec3i& voxel, int axis) const {
  const Vec3i before = voxel + step_along(axis, -1), after = voxel + step_along(axis, 1);
  const bool has_before = is_linked(before, axis), has_after = is_linked(voxel, axis);
  if (!has_before && !has_after) return Vec3d(0);
  const Vec3i& lo = has_before ? before : voxel;
  const Vec3i& hi = has_after ? after : voxel;
  return (at(hi) - at(lo)) * (has_before && has_after ? 0.5 : 1.0);
}

Columns LinkedElements::gradient(const Vec3i& voxel) const {
  return {derivative(voxel, 0), derivative(voxel, 1), derivative(voxel, 2)};
}

double LinkedElements::jacobian(const Vec3i& voxel) const {
  Columns F = identity_columns();
  const Columns grad = gradient(voxel);
  for (int axis = 0; axis < 3; ++axis) F[axis] += grad[axis];
  return determinant(F);
}

bool LinkedElements::mixed_derivative(const Vec3i& voxel, int a, int b, Vec3d& mixed) const {
  mixed = Vec3d(0);
  for (const int side_a : {-1, 1}) {
    for (const int side_b : {-1, 1}) {
      const Vec3i beside_a = voxel + step_along(a, side_a),
                  beside_b = voxel + step_along(b, side_b);
      if (!is_linked_to_side(beside_a, b, side_b) || !is_linked_to_side(beside_b, a, side_a)) {
        return false;
      }
      mixed += at(beside_a + step_along(b, side_b)) * (0.25 * side_a * side_b);
    }
  }
  return true;
}

bool LinkedElements::second_derivatives(const Vec3i& voxel, SecondDerivatives& D) const {
  const Vec3d here = at(voxel);
  for (auto& row : D) row.fill(Vec3d(0));
  for (int a = 0; a < 3; ++a) {
    if (m_dims[a] == 1) continue;
    Vec3d both(0);
    for (const int side : {-1, 1}) {
      if (!is_linked_to_side(voxel, a, side)) return false;
      both += at(voxel + step_along(a, side));
    }
    D[a][a] = both - here * 2;
  }
  for (int a = 0; a < 3; ++a) {
    for (int b = a + 1; b < 3; ++b) {
      if (m_dims[a] == 1 || m_dims[b] == 1) continue;
      if (!mixed_derivative(voxel, a, b, D[a][b])) return false;
      D[b][a] = D[a][b];
    }
  }
  return true;
}

bool LinkedElements::is_folded(const Vec3i& voxel) const {
  CellCorners corners;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3i step = cell_corner(corner);
    for (int axis = 0; axis < 3; ++axis) {
      if (step[axis] == 0 && !is_linked(voxel + step, axis)) return false;
    }
    const Vec3d place = Vec3d(step) + at(voxel + step);
    for (int c = 0; c < 3; ++c) corners.p[c][corner] = place[c];
  }
  return supple::is_folded(corners);
}

}  // namespace supple
