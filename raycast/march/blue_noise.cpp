#include "raycast/march/blue_noise.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <random>

namespace supple {

namespace {

constexpr int kSide = 64, kPixels = kSide * kSide;
constexpr int kReach = 7;       // pixels; beyond, the energy of a point is nothing
constexpr double kSigma = 1.5;  // Ulichney's choice
constexpr int kFirstPoints = kPixels / 10;

/// Points on a torus and the energy that they spread around them.
class Points {
 public:
  Points() {
    for (int n = 0; n < kBox * kBox; ++n) {
      const int x = n % kBox - kReach, y = n / kBox - kReach;
      m_kernel[n] = std::exp(-(x * x + y * y) / (2 * kSigma * kSigma));
    }
  }
  bool has(int pixel) const { return m_has[pixel]; }
  void add(int pixel) { set(pixel, true); }
  void remove(int pixel) { set(pixel, false); }

  /// The point with the most energy around it.
  int tightest_cluster() const { return extreme(true, -1); }
  /// The empty pixel with the least energy around it.
  int largest_void() const { return extreme(false, 1); }

 private:
  static constexpr int kBox = 2 * kReach + 1;

  void set(int pixel, bool present) {
    m_has[pixel] = present;
    for (int n = 0; n < kBox * kBox; ++n) {
      const int x = (pixel % kSide + n % kBox - kReach + kSide) % kSide;
      const int y = (pixel / kSide + n / kBox - kReach + kSide) % kSide;
      m_energy[y * kSide + x] += present ? m_kernel[n] : -m_kernel[n];
    }
  }
  int extreme(bool present, double sign) const {
    int best = -1;
    for (int pixel = 0; pixel < kPixels; ++pixel) {
      if (m_has[pixel] != present) continue;
      if (best < 0 || sign * m_energy[pixel] < sign * m_energy[best]) best = pixel;
    }
    return best;
  }

  std::array<double, kBox * kBox> m_kernel;
  std::array<double, kPixels> m_energy{};
  std::array<bool, kPixels> m_has{};
};

/// An even spread of few points: clusters move into voids until that changes nothing.
Points first_pattern() {
  Points points;
  std::mt19937 random(1);
  for (int count = 0; count < kFirstPoints;) {
    const int pixel = int(random() % kPixels);
    if (points.has(pixel)) continue;
    points.add(pixel);
    ++count;
  }
  while (true) {
    const int from = points.tightest_cluster();
    points.remove(from);
    const int to = points.largest_void();
    points.add(to);
    if (to == from) return points;
  }
}

using Tile = std::array<std::uint16_t, kPixels>;

Tile make_tile() {
  Tile rank{};
  const Points first = first_pattern();
  Points fewer = first;
  for (int n = kFirstPoints - 1; n >= 0; --n) {
    const int pixel = fewer.tightest_cluster();
    fewer.remove(pixel);
    rank[pixel] = std::uint16_t(n);
  }
  Points more = first;
  for (int n = kFirstPoints; n < kPixels; ++n) {
    const int pixel = more.largest_void();
    more.add(pixel);
    rank[pixel] = std::uint16_t(n);
  }
  return rank;
}

}  // namespace

float blue_noise(int x, int y) {
  static const Tile tile = make_tile();
  return (float(tile[(y & (kSide - 1)) * kSide + (x & (kSide - 1))]) + 0.5f) / kPixels;
}

}  // namespace supple
