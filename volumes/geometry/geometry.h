// Places of voxels in the patient: a full affine from the index frame to LPS millimetres.
// Cost: a value type of 18 doubles; the inverse is kept beside the forward axes.
#pragma once

#include <array>

#include "volumes/base/vec.h"

namespace supple {

/// Index frame: voxel (i, j, k), i fastest in memory, voxel centres at integers, unit voxel.
/// World frame: LPS (x to the patient's left, y to posterior, z to superior), unit mm.
/// Any invertible affine is allowed, sheared and left-handed ones included.
class Geometry {
 public:
  /// One voxel of 1 mm at the origin, axes along L, P, S.
  Geometry();

  /// `axes_mm[a]`: world vector in mm of one step along index axis a (spacing times direction).
  /// Throws InputError when a dimension is < 1, their product exceeds 2^40, a value is not
  /// finite, or the axes are singular (|det| of the unit directions < 1e-6).
  Geometry(const Vec3i& dims, const Vec3d& origin_lps_mm, const std::array<Vec3d, 3>& axes_mm);

  const Vec3i& dims() const { return m_dims; }
  const Vec3d& origin_lps_mm() const { return m_origin; }
  const std::array<Vec3d, 3>& axes_mm() const { return m_axes; }

  /// Lengths of the axes in mm.
  Vec3d spacing_mm() const;
  /// Unit vectors of i, j, k in LPS.
  std::array<Vec3d, 3> direction() const;
  /// Determinant of the axes in mm^3; negative for a left-handed index frame.
  double determinant() const;
  /// True when i, j, k are mutually perpendicular within `tolerance` (cosine of the angle).
  bool is_orthogonal(double tolerance = 1e-4) const;
  long long voxel_count() const;

  Vec3d world_from_index(const Vec3d& index) const;
  Vec3d index_from_world(const Vec3d& world_mm) const;
  Vec3d world_vector_from_index(const Vec3d& step) const;
  Vec3d index_vector_from_world(const Vec3d& vector_mm) const;
  /// Transforms an index-space gradient (a covector) to world: (A^-T) g, unit 1/mm.
  Vec3d world_gradient_from_index(const Vec3d& gradient) const;

  /// A geometry of the same affine and other dimensions.
  Geometry with_dims(const Vec3i& dims) const;

  bool operator==(const Geometry& other) const;

 private:
  Vec3i m_dims;
  Vec3d m_origin;
  std::array<Vec3d, 3> m_axes;
  std::array<Vec3d, 3> m_inverse_rows;  // row a: index coordinate a of a world vector
};

// Turns in space as unit quaternions.

struct Turn {
  double w = 1;  // cosine of half the angle
  Vec3d v{0, 0, 0};

  Turn operator*(const Turn& first) const;  // `first`, then this
  Turn inverse() const { return {w, -v}; }
  Vec3d operator()(const Vec3d& x) const { return x + way_of(x); }
  /// Way from x to where it goes; exactly 0 without a turn.
  Vec3d way_of(const Vec3d& x) const;
  bool operator==(const Turn& other) const { return w == other.w && v == other.v; }
  bool turns() const { return v != Vec3d(0); }
  double squared_length() const { return w * w + v.dot(v); }
  /// The same turn as a quaternion of length 1 with w >= 0.
  Turn unit() const;
  /// Angle of the turn, 0 to 180 degrees, and its axis, of unit length.
  double angle_deg() const;
  Vec3d axis() const;
};

/// A right-handed turn about an axis of any length but 0.
Turn turn_about(const Vec3d& axis, double angle_deg);
/// The turn that takes x, y and z to three perpendicular unit vectors, right-handed.
Turn turn_to(const std::array<Vec3d, 3>& axes);

/// A turn on the shortest arc, at an even speed (slerp); beyond 0 and 1 it goes on.
Turn between(const Turn& a, const Turn& b, double s);

}  // namespace supple
