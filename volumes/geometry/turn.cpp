#include <cmath>

#include "volumes/base/units.h"
#include "volumes/geometry/geometry.h"

namespace supple {

namespace {

double dot(const Turn& a, const Turn& b) {
  return a.w * b.w + a.v.dot(b.v);
}

Turn normalised(const Turn& turn) {
  const double length = std::sqrt(dot(turn, turn));
  return {turn.w / length, turn.v / length};
}

}  // namespace

Turn Turn::operator*(const Turn& first) const {
  return {w * first.w - v.dot(first.v), first.v * w + v * first.w + v.cross(first.v)};
}

Vec3d Turn::way_of(const Vec3d& x) const {
  const Vec3d twice = v.cross(x) * 2.0;
  return twice * w + v.cross(twice);
}

Turn Turn::unit() const {
  const double scale = (w < 0 ? -1 : 1) / std::sqrt(squared_length());
  return {w * scale, v * scale};
}

double Turn::angle_deg() const {
  return std::atan2(v.length(), std::abs(w)) * 360 / kPi;
}

Vec3d Turn::axis() const {
  if (v == Vec3d(0)) return {0, 0, 1};
  return w < 0 ? -v.normalized() : v.normalized();
}

Turn turn_about(const Vec3d& axis, double angle_deg) {
  const double half = angle_deg * kPi / 360;
  return {std::cos(half), axis.normalized() * std::sin(half)};
}

/// Finds the largest component first (Shepperd 1978).
Turn turn_to(const std::array<Vec3d, 3>& axes) {
  const auto m = [&](int row, int column) { return axes[std::size_t(column)][row]; };
  const double trace = m(0, 0) + m(1, 1) + m(2, 2);
  int largest = 0;
  for (int a = 1; a < 3; ++a) {
    if (m(a, a) > m(largest, largest)) largest = a;
  }
  if (trace > m(largest, largest)) {
    const Vec3d v(m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1));
    return normalised({1 + trace, v});
  }
  const int i = largest, j = (i + 1) % 3, k = (i + 2) % 3;
  Turn turn;
  turn.w = m(k, j) - m(j, k);
  turn.v[i] = 1 + m(i, i) - m(j, j) - m(k, k);
  turn.v[j] = m(i, j) + m(j, i);
  turn.v[k] = m(i, k) + m(k, i);
  return normalised(turn);
}

Turn between(const Turn& a, const Turn& b, double s) {
  const Turn way = (dot(a, b) < 0 ? Turn{-b.w, -b.v} : b) * a.inverse();
  const double sine = way.v.length();
  if (sine == 0) return a;
  const double half = std::atan2(sine, way.w) * s;
  return normalised(Turn{std::cos(half), way.v * (std::sin(half) / sine)} * a);
}

}  // namespace supple
