#include "lib/session/hand/hand_span.h"

#include <array>
#include <cmath>

#include "volumes/geometry/geometry.h"

namespace supple {

namespace {

/// Parts of a target that no direction has: less of it, or a shorter shift, is left to the step.
constexpr double kOwnPart = 1e-4, kOwnShift_mm = 1e-3;
constexpr double kDirection_mm = 10;

template <std::size_t N>
using Numbers = std::array<double, N>;

template <std::size_t N>
double length_of(const Numbers<N>& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

/// Span of vectors, as an orthonormal basis (Gram and Schmidt, twice).
template <std::size_t N>
class Span {
 public:
  Numbers<N> rest_of(Numbers<N> v) const {
    for (int twice = 0; twice < 2; ++twice) {
      for (const Numbers<N>& axis : m_basis) {
        double part = 0;
        for (std::size_t n = 0; n < N; ++n) part += axis[n] * v[n];
        for (std::size_t n = 0; n < N; ++n) v[n] -= part * axis[n];
      }
    }
    return v;
  }
  bool lacks(const Numbers<N>& v) const { return length_of(rest_of(v)) > kOwnPart * length_of(v); }
  void add(const Numbers<N>& v) {
    if (!lacks(v)) return;
    Numbers<N> rest = rest_of(v);
    const double length = length_of(rest);
    for (double& x : rest) x /= length;
    m_basis.push_back(rest);
  }

 private:
  std::vector<Numbers<N>> m_basis;
};

/// Steps of a turn: its matrix less the identity, by columns.
Numbers<9> map_of(const HandleMotion& motion) {
  const Turn turn = turn_about(motion.axis_lps, motion.angle_deg);
  Numbers<9> map;
  for (std::size_t a = 0; a < 3; ++a) {
    Vec3d unit(0);
    unit[int(a)] = 1;
    const Vec3d step = turn(unit) - unit;
    for (std::size_t c = 0; c < 3; ++c) map[3 * a + c] = step[int(c)];
  }
  return map;
}

Vec3d rounded(Vec3d v, double parts) {
  for (int a = 0; a < 3; ++a) v[a] = std::round(v[a] * parts) / parts;
  return v;
}

}  // namespace

std::vector<HandDirection> lacking_directions(const DragPose& target,
                                              const std::vector<HandDirection>& directions,
                                              const Geometry& geometry) {
  Span<3> shifts;
  Span<9> maps;
  bool turns = false;
  for (const HandDirection& direction : directions) {
    turns = turns || direction.turn_deg != 0;
    if (direction.turn_deg != 0) {
      maps.add(map_of(direction.pose(geometry).motion));
    } else {
      shifts.add({direction.way.x, direction.way.y, direction.way.z});
    }
  }
  std::vector<HandDirection> lacking;
  const auto add = [&](const HandDirection& direction) {
    if (directions.size() + lacking.size() < kMostDirections) lacking.push_back(direction);
  };
  const Numbers<3> by = {target.by_mm.x, target.by_mm.y, target.by_mm.z};
  const Numbers<3> rest = shifts.rest_of(by);
  const double rest_mm = length_of(rest);
  if (shifts.lacks(by) && rest_mm > kOwnShift_mm) {
    add({rounded(Vec3d(rest[0], rest[1], rest[2]) * (kDirection_mm / rest_mm), 1e3)});
  }
  const HandleMotion& motion = target.motion;
  if (motion.angle_deg == 0 || !maps.lacks(map_of(motion))) return lacking;
  const Vec3d along = geometry.index_vector_from_world(motion.axis_lps) * geometry.spacing_mm();
  const Vec3d axis = rounded(along / along.length(), 1e6);
  std::vector<HandDirection> candidates = {{axis, 90}, {axis, 180}};
  if (turns) {
    candidates = {{{1, 0, 0}, 90},  {{1, 0, 0}, 180}, {{0, 1, 0}, 90},
                  {{0, 1, 0}, 180}, {{0, 0, 1}, 90},  {{0, 0, 1}, 180},
                  {{1, 1, 0}, 180}, {{0, 1, 1}, 180}, {{1, 0, 1}, 180}};
  }
  for (const HandDirection& candidate : candidates) {
    const Numbers<9> map = map_of(candidate.pose(geometry).motion);
    if (!maps.lacks(map)) continue;
    maps.add(map);
    add(candidate);
  }
  return lacking;
}

}  // namespace supple
