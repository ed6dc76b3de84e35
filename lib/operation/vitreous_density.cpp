#include "lib/operation/vitreous_density.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "volumes/base/random.h"

namespace supple {

namespace {

constexpr float kGel = 14, kBase = 40;      // density of the gel, and more of it at the base
constexpr float kFibril = 120, kClot = 90;  // at their middle
constexpr int kFibrils = 160, kClots = 8;
constexpr double kBaseHeight = 0.55;  // of the base, in radii above the middle

Vec3d in_ball(RandomNumbers& draws) {
  for (;;) {
    const double x = 2 * draws.next() - 1, y = 2 * draws.next() - 1, z = 2 * draws.next() - 1;
    const Vec3d v(x, y, z);
    if (v.dot(v) <= 1) return v;
  }
}

/// Rational bell, 1 at 0 and 0 from `width` on: the same bits on all machines.
float bell(double square, double width) {
  const double part = 1 - square / (width * width);
  return part <= 0 ? 0 : float(part * part);
}

class DensityPainter {
 public:
  explicit DensityPainter(const BrickTopology& elements)
      : m_elements(elements), m_values(elements.brick_count() * kBrickVoxels, 0) {}

  /// Raises the densities around a place to at least a bell of that height.
  void dab(const Vec3d& place, double width, float height) {
    const Vec3i lo = floor_voxel(place - Vec3d(width)), hi = floor_voxel(place + Vec3d(width + 1));
    for (int i = lo.x; i <= hi.x; ++i) {
      for (int j = lo.y; j <= hi.y; ++j) {
        for (int k = lo.z; k <= hi.z; ++k) {
          const std::int32_t brick = m_elements.find({i, j, k});
          if (brick < 0) continue;
          const Vec3d away = Vec3d(i, j, k) - place;
          float& value =
              m_values[std::size_t(brick) * kBrickVoxels + std::size_t(brick_offset({i, j, k}))];
          value = std::max(value, height * bell(away.dot(away), width));
        }
      }
    }
  }
  std::vector<float>& values() { return m_values; }

 private:
  const BrickTopology& m_elements;
  std::vector<float> m_values;
};

/// A strand that wanders through the ball.
void paint_fibril(DensityPainter& painter, RandomNumbers& draws, const Vec3d& centre,
                  double radius) {
  Vec3d place = centre + in_ball(draws) * radius;
  Vec3d way = in_ball(draws);
  const int steps = int(radius * (0.5 + draws.next()));
  const float height = kFibril * float(0.4 + 0.6 * draws.next());
  for (int n = 0; n < steps; ++n) {
    painter.dab(place, 1.5, height);
    way = (way * 4.0 + in_ball(draws)).normalized();
    place += way;
  }
}

float gel_at(const Vec3d& from_centre, double radius) {
  const double height = from_centre.z / radius - kBaseHeight;
  const double depth = 1 - std::sqrt(from_centre.dot(from_centre)) / radius;
  return kGel + kBase * bell(height * height, 0.5) * bell(depth * depth, 0.4);
}

}  // namespace

DensityGrid make_vitreous_density(const BrickTopology& elements, const Vec3d& centre,
                                  double radius_voxels, std::uint64_t seed) {
  RandomNumbers draws(seed);
  DensityPainter painter(elements);
  for (int n = 0; n < kFibrils; ++n) paint_fibril(painter, draws, centre, radius_voxels);
  for (int n = 0; n < kClots; ++n) {
    const Vec3d place = centre + in_ball(draws) * radius_voxels;
    painter.dab(place, 1.5 + 2.5 * draws.next(), kClot);
  }
  std::vector<float>& values = painter.values();
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for (int n = 0; n < kBrickVoxels; ++n) {
      float& value = values[b * kBrickVoxels + std::size_t(n)];
      const bool is_active = mask_test(elements.mask(b), n);
      const Vec3d at = Vec3d(elements.origin(b) + brick_local(n)) - centre;
      value = is_active ? std::min(255.0f, value + gel_at(at, radius_voxels)) : 0;
    }
  }
  return make_density_grid(elements, values, 0);
}

}  // namespace supple
