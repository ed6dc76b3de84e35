#include "volumes/field/landmarks/spline_sum.h"

#include <algorithm>
#include <cmath>

namespace supple {

SplineSum::SplineSum(std::vector<Centre> centres, const Affine& affine)
    : m_centres(std::move(centres)), m_affine(affine) {}

Vec3d SplineSum::at(const Vec3d& x) const {
  Vec3d vector;
  row(x, Vec3d(0), 1, &vector);
  return vector;
}

void SplineSum::row(const Vec3d& first, const Vec3d& step, int count, Vec3d* out) const {
  constexpr int kLanes = 32;  // whose sums stay in registers and the nearest cache
  double x[kLanes], y[kLanes], z[kLanes], u[kLanes], v[kLanes], w[kLanes];
  for (int begin = 0; begin < count; begin += kLanes) {
    for (int n = 0; n < kLanes; ++n) {
      const Vec3d place = first + step * double(begin + n) - m_affine.origin;
      const Vec3d vector = m_affine.at_origin + m_affine.along[0] * place.x +
                           m_affine.along[1] * place.y + m_affine.along[2] * place.z;
      x[n] = place.x, y[n] = place.y, z[n] = place.z;
      u[n] = vector.x, v[n] = vector.y, w[n] = vector.z;
    }
    for (const Centre& centre : m_centres) {
      const Vec3d c = centre.at - m_affine.origin, weight = centre.weight;
      for (int n = 0; n < kLanes; ++n) {
        const double dx = x[n] - c.x, dy = y[n] - c.y, dz = z[n] - c.z;
        const double distance = std::sqrt(dx * dx + dy * dy + dz * dz);
        u[n] += weight.x * distance;
        v[n] += weight.y * distance;
        w[n] += weight.z * distance;
      }
    }
    const int rest = std::min(kLanes, count - begin);
    for (int n = 0; n < rest; ++n) out[begin + n] = Vec3d(u[n], v[n], w[n]);
  }
}

}  // namespace supple
