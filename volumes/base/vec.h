// Small vectors of the whole project, taken from Imath (a dependency of OpenVDB).
// `*` and `/` between two vectors work component by component; see Imath for dot and cross.
#pragma once

#include <algorithm>
#include <cmath>

#include <Imath/ImathVec.h>

namespace supple {

using Vec3d = Imath::Vec3<double>;
using Vec3f = Imath::Vec3<float>;
using Vec3i = Imath::Vec3<int>;

/// The voxel at or below a position, per coordinate.
inline Vec3i floor_voxel(const Vec3d& pos) {
  return {int(std::floor(pos.x)), int(std::floor(pos.y)), int(std::floor(pos.z))};
}

/// Positions beyond this have no voxel; it also keeps NaN away from the integer conversion.
constexpr double kMaxCoordinate = 1e9;

/// The nearest voxel; halves go away from 0.
inline Vec3i nearest_voxel(const Vec3d& pos) {
  Vec3i voxel;
  for (int c = 0; c < 3; ++c) {
    voxel[c] = int(std::lround(std::clamp(pos[c], -kMaxCoordinate, kMaxCoordinate)));
  }
  return voxel;
}

inline bool is_finite(const Vec3d& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// True if a comes before b in the order of x, then y, then z.
inline bool voxel_less(const Vec3i& a, const Vec3i& b) {
  if (a.x != b.x) return a.x < b.x;
  return a.y != b.y ? a.y < b.y : a.z < b.z;
}

/// Box of voxels in the index frame; both corners belong to it.
struct IndexBox {
  Vec3i lo{0, 0, 0};
  Vec3i hi{-1, -1, -1};

  bool empty() const { return hi.x < lo.x || hi.y < lo.y || hi.z < lo.z; }
  bool contains(const Vec3i& p) const {
    return p.x >= lo.x && p.x <= hi.x && p.y >= lo.y && p.y <= hi.y && p.z >= lo.z && p.z <= hi.z;
  }
  bool operator==(const IndexBox& other) const { return lo == other.lo && hi == other.hi; }
};

}  // namespace supple
