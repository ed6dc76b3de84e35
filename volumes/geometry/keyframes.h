// Values between keyframes, as animation programs have them: each key says how its value goes on to
// the next. A value is anything with a between(a, b, s), s beyond 0…1 included.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

/// From a key to the next. smooth: starts and ends at rest, 3 s^2 - 2 s^3; spline: passes through
/// the keys without a stop, a Catmull-Rom spline over the times of the keys, which may go beyond
/// their values; hold: jumps at the next key.
enum class Easing { smooth, linear, spline, hold };

inline double between(double a, double b, double s) {
  return a + (b - a) * s;
}
inline Vec3d between(const Vec3d& a, const Vec3d& b, double s) {
  return a + (b - a) * s;
}

template <class Value>
class Track {
 public:
  /// Adds a key; times ascend.
  void add(double time, const Value& value, Easing easing) {
    m_keys.push_back({time, value, easing});
  }
  bool empty() const { return m_keys.empty(); }
  /// Time of the last key.
  double end() const { return m_keys.back().time; }

  /// The value at a time; outside of the keys it is that of the nearest one. Needs a key.
  Value at(double time) const {
    const auto after = std::upper_bound(m_keys.begin(), m_keys.end(), time,
                                        [](double t, const Key& key) { return t < key.time; });
    if (after == m_keys.begin()) return m_keys.front().value;
    if (after == m_keys.end()) return m_keys.back().value;
    const Key &a = *(after - 1), &b = *after;
    const double s = (time - a.time) / (b.time - a.time);
    switch (a.easing) {
      case Easing::hold:
        return a.value;
      case Easing::linear:
        return between(a.value, b.value, s);
      case Easing::smooth:
        return between(a.value, b.value, s * s * (3 - 2 * s));
      case Easing::spline:
        break;
    }
    return on_spline(std::size_t(after - m_keys.begin()) - 1, time);
  }

 private:
  struct Key {
    double time;
    Value value;
    Easing easing;
  };

  /// The pyramid of Barry and Goldman (SIGGRAPH 1988), which needs no more than between(), so that
  /// turns have the same spline (Schlag, Graphics Gems II). Beyond the ends the track goes on
  /// straight.
  Value on_spline(std::size_t n, double time) const {
    const Key &b = m_keys[n], &c = m_keys[n + 1];
    const Key a =
        n > 0 ? m_keys[n - 1] : Key{2 * b.time - c.time, between(b.value, c.value, -1), b.easing};
    const Key d = n + 2 < m_keys.size()
                      ? m_keys[n + 2]
                      : Key{2 * c.time - b.time, between(b.value, c.value, 2), c.easing};
    const auto part = [&](const Key& from, const Key& to) {
      return (time - from.time) / (to.time - from.time);
    };
    const Value ab = between(a.value, b.value, part(a, b));
    const Value bc = between(b.value, c.value, part(b, c));
    const Value cd = between(c.value, d.value, part(c, d));
    return between(between(ab, bc, part(a, c)), between(bc, cd, part(b, d)), part(b, c));
  }

  std::vector<Key> m_keys;
};

}  // namespace supple
