// Small vectors of the whole project, taken from Imath (a dependency of OpenVDB).
// `*` and `/` between two vectors work component by component; see Imath for dot and cross.
#pragma once

#include <Imath/ImathVec.h>

namespace supple {

using Vec3d = Imath::Vec3<double>;
using Vec3f = Imath::Vec3<float>;
using Vec3i = Imath::Vec3<int>;

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
