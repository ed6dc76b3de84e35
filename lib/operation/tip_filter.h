// Parts of a tip's motion by frequency: where a hand leads it, and how it trembles.
//
// State-variable filter of second order by the trapezoidal rule [Zavalishin, The Art of VA Filter
// Design, 4.4]: with g = pi f dt and damping k
//   v1 = (s1 + g (x - s2)) / (1 + g (g + k)),  v2 = s2 + g v1,  low = v2,  high = x - k v1 - v2,
//   s1 <- 2 v1 - s1,  s2 <- 2 v2 - s2.
// Its states are kept where the length of a step changes. The tangent that would put the cutoff
// exactly at f is left out, so that the same bits come out on all machines: at 4 Hz and steps of
// 20 ms the cutoff is 2 % lower.
#pragma once

#include "volumes/base/units.h"
#include "volumes/base/vec.h"

namespace supple {

class PlaceFilter {
 public:
  struct Bands {
    Vec3d low, high;
  };

  PlaceFilter(double cutoff_hz, double damping) : m_cutoff_hz(cutoff_hz), m_damping(damping) {}

  /// Takes the place a step later. The first one is taken as one at rest, and so is one after a
  /// step that is too long to tell how the place got there.
  Bands take(const Vec3d& place, double dt_s) {
    constexpr double kLongestStep_s = 0.1;
    if (!m_has_begun || dt_s > kLongestStep_s) {
      m_has_begun = true;
      m_s1 = Vec3d(0);
      m_s2 = place;
      return {place, Vec3d(0)};
    }
    const double g = kPi * m_cutoff_hz * dt_s;
    const Vec3d v1 = (m_s1 + (place - m_s2) * g) / (1 + g * (g + m_damping));
    const Vec3d v2 = m_s2 + v1 * g;
    m_s1 = v1 * 2.0 - m_s1;
    m_s2 = v2 * 2.0 - m_s2;
    return {v2, place - v1 * m_damping - v2};
  }

 private:
  double m_cutoff_hz, m_damping;
  bool m_has_begun = false;
  Vec3d m_s1{0, 0, 0}, m_s2{0, 0, 0};
};

/// Place to which a hand leads a tip, without its tremor: what is above 8 Hz comes through by a
/// part of 1/280 at most, without overshoot and 0.32 s late.
class SteadyTip {
 public:
  Vec3d take(const Vec3d& tip_mm, double dt_s) {
    return m_second.take(m_first.take(tip_mm, dt_s).low, dt_s).low;
  }

 private:
  PlaceFilter m_first{2, 2}, m_second{2, 2};
};

/// Motion of a tip above 4 Hz: constant speed leaves none.
class TipTremor {
 public:
  Vec3d take(const Vec3d& tip_mm, double dt_s) { return m_filter.take(tip_mm, dt_s).high; }

 private:
  PlaceFilter m_filter{4, 1.4142135623730951};
};

}  // namespace supple
