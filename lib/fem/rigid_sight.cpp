#include "lib/fem/rigid_sight.h"

#include <cmath>

namespace supple {

namespace {

/// Relative pivots below this are rounding.
constexpr double kRankTolerance = 1e-9;

int rank_of(std::array<std::array<double, 6>, 6> gram) {
  // Motions scaled alike, then elimination with the largest pivot.
  std::array<double, 6> scale;
  for (int n = 0; n < 6; ++n) scale[n] = gram[n][n] > 0 ? 1 / std::sqrt(gram[n][n]) : 0;
  for (int n = 0; n < 6; ++n) {
    for (int m = 0; m < 6; ++m) gram[n][m] *= scale[n] * scale[m];
  }
  std::array<bool, 6> is_done{};
  for (int rank = 0; rank < 6; ++rank) {
    int pivot = -1;
    for (int n = 0; n < 6; ++n) {
      if (!is_done[n] && (pivot < 0 || gram[n][n] > gram[pivot][pivot])) pivot = n;
    }
    if (gram[pivot][pivot] < kRankTolerance) return rank;
    is_done[pivot] = true;
    for (int n = 0; n < 6; ++n) {
      if (is_done[n]) continue;
      const double factor = gram[n][pivot] / gram[pivot][pivot];
      for (int m = 0; m < 6; ++m) gram[n][m] -= factor * gram[pivot][m];
    }
  }
  return 6;
}

}  // namespace

void RigidSight::see(const Vec3d& position, std::uint8_t bits) {
  if (!m_has_any) m_about = position;
  m_has_any = true;
  const Vec3d arm = position - m_about;
  for (int a = 0; a < 3; ++a) {
    if ((bits >> a & 1) == 0) continue;
    // Component a of the motions: three translations, three rotations w x arm.
    const Vec3d turned[3] = {{0, -arm.z, arm.y}, {arm.z, 0, -arm.x}, {-arm.y, arm.x, 0}};
    std::array<double, 6> motion{};
    motion[a] = 1;
    for (int axis = 0; axis < 3; ++axis) motion[3 + axis] = turned[axis][a];
    for (int n = 0; n < 6; ++n) {
      for (int m = 0; m < 6; ++m) m_gram[n][m] += motion[n] * motion[m];
    }
  }
}

bool RigidSight::prevents_all() const {
  return rank_of(m_gram) == 6;
}

}  // namespace supple
