#include "lib/chainmail/ball_links.h"

#include <cmath>

namespace supple {

BallLinks::BallLinks(const Body& body) : m_stride(body.slacks.stride()) {
  std::array<Vec3d, 3> step_mm;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d step(0);
    step[axis] = 1;
    step_mm[std::size_t(axis)] = body.geometry.world_vector_from_index(step);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) m_products[a][b] = step_mm[a].dot(step_mm[b]);
    m_rest_mm[a] = std::sqrt(m_products[a][a]);
  }

  const MaterialClasses classes(body.material);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    m_ranges[axis].resize(std::size_t(255 * m_stride + 256));
    classes.for_each_pair(int(axis), [&](int a, int b, const LinkLimits& limits) {
      m_ranges[axis][std::size_t(a * m_stride + b)] = {limits.min_length * m_rest_mm[axis],
                                                       limits.max_length * m_rest_mm[axis]};
    });
  }
}

double BallLinks::length_mm(const Vec3d& link) const {
  double square = 0;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      square += link[a] * link[b] * m_products[std::size_t(a)][std::size_t(b)];
    }
  }
  return std::sqrt(std::max(0.0, square));
}

std::size_t BallLinks::bytes() const {
  std::size_t total = sizeof *this;
  for (const auto& ranges : m_ranges) total += ranges.capacity() * sizeof(Range);
  return total;
}

}  // namespace supple
