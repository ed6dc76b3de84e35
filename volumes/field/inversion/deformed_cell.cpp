#include "volumes/field/inversion/deformed_cell.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace supple {

namespace {

// Local coordinates this far outside still belong to the cell, so that what Newton leaves opens no
// gap between neighbours; they are clamped to the cell.
constexpr double kEdge = 1e-5;
// Newton stops at this part of the tolerance, well below the width of that edge.
constexpr double kNewtonPart = 1e-2;
// Half width of the box on which a cell is tested for injectivity.
constexpr double kInjectiveHalf = 0.75;
// Volume of the unit parallelepiped along G below which G counts as singular.
constexpr double kSingular = 1e-9;
// det J of the preconditioned equation above which a Newton step is solved directly.
constexpr double kRegular = 1e-3;
constexpr int kMaxDepth = 7;
constexpr int kMaxBoxes = 1000;

Vec3d abs(const Vec3d& v) {
  return {std::abs(v.x), std::abs(v.y), std::abs(v.z)};
}
double max_component(const Vec3d& v) {
  return std::max({v.x, v.y, v.z});
}
double max_abs(const Vec3d& v) {
  return max_component(abs(v));
}

Vec3d clamp(const Vec3d& v, double half) {
  return {std::clamp(v.x, -half, half), std::clamp(v.y, -half, half), std::clamp(v.z, -half, half)};
}

double det(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return a.dot(b.cross(c));
}

/// Sums of the corner values with the signs of a product of coordinates.
struct Moments {
  double mean, x, y, z, xy, yz, xz, xyz;
};
Moments moments(const double (&v)[8]) {
  // Sums and differences along z, then y, then x.
  const double s00 = v[0] + v[1], d00 = v[1] - v[0], s01 = v[2] + v[3], d01 = v[3] - v[2];
  const double s10 = v[4] + v[5], d10 = v[5] - v[4], s11 = v[6] + v[7], d11 = v[7] - v[6];
  const double ss0 = s00 + s01, ds0 = s01 - s00, sd0 = d00 + d01, dd0 = d01 - d00;
  const double ss1 = s10 + s11, ds1 = s11 - s10, sd1 = d10 + d11, dd1 = d11 - d10;
  return {(ss0 + ss1) / 8, (ss1 - ss0) / 4, (ds0 + ds1) / 4, (sd0 + sd1) / 4,
          (ds1 - ds0) / 2, (dd0 + dd1) / 2, (sd1 - sd0) / 2, dd1 - dd0};
}

/// Solves J step = residual; where J (columns jx, jy, jz) is singular, the shortest step in the
/// least-squares sense.
Vec3d newton_step(const Vec3d& jx, const Vec3d& jy, const Vec3d& jz, const Vec3d& residual) {
  const Vec3d yz = jy.cross(jz);
  const double volume = jx.dot(yz);
  if (std::abs(volume) > kRegular) {
    const double inverse = 1 / volume;
    const Vec3d xr = jx.cross(residual);
    return {residual.dot(yz) * inverse, xr.dot(jz) * inverse, -xr.dot(jy) * inverse};
  }
  const double size = std::max({jx.length2(), jy.length2(), jz.length2()});
  if (size == 0) return Vec3d(0);
  const double ridge = 1e-8 * size;
  const Vec3d a(jx.dot(jx) + ridge, jx.dot(jy), jx.dot(jz));
  const Vec3d b(jx.dot(jy), jy.dot(jy) + ridge, jy.dot(jz));
  const Vec3d c(jx.dot(jz), jy.dot(jz), jz.dot(jz) + ridge);
  const Vec3d r(jx.dot(residual), jy.dot(residual), jz.dot(residual));
  return Vec3d(det(r, b, c), det(a, r, c), det(a, b, r)) / det(a, b, c);
}

}  // namespace

/// Right side of the preconditioned equation and when it counts as solved.
struct DeformedCell::Target {
  Vec3d t;
  double tolerance;
  int max_steps;
};

/// State of a bisection: all solutions compete for the smallest |local - x|.
struct DeformedCell::Search {
  const Target& target;
  Vec3d x;
  Vec3d best;
  double best_squared = -1;
  int boxes = 0;
  bool undecided = false;
};

DeformedCell::DeformedCell(const CellCorners& corners, bool folded) : m_folded(folded) {
  // Centre, linear part and bent part.
  Vec3d gx, gy, gz;
  for (int a = 0; a < 3; ++a) {
    const Moments s = moments(corners.p[a]);
    m_center[a] = s.mean;
    gx[a] = s.x;
    gy[a] = s.y;
    gz[a] = s.z;
    m_xy[a] = s.xy;
    m_yz[a] = s.yz;
    m_xz[a] = s.xz;
    m_xyz[a] = s.xyz;
  }

  // Precondition by the inverse of G.
  const double volume = det(gx, gy, gz);
  const double size = std::max({gx.length2(), gy.length2(), gz.length2()});
  m_singular = !(std::abs(volume) > kSingular * size * std::sqrt(size));
  if (m_singular) {
    m_inverse_rows[0] = {1, 0, 0};
    m_inverse_rows[1] = {0, 1, 0};
    m_inverse_rows[2] = {0, 0, 1};
    m_rest[0] = gx - m_inverse_rows[0];
    m_rest[1] = gy - m_inverse_rows[1];
    m_rest[2] = gz - m_inverse_rows[2];
    return;
  }
  m_scale = std::sqrt(size);
  const double inverse = 1 / volume;
  m_inverse_rows[0] = gy.cross(gz) * inverse;
  m_inverse_rows[1] = gz.cross(gx) * inverse;
  m_inverse_rows[2] = gx.cross(gy) * inverse;
  const auto precondition = [&](const Vec3d& v) {
    return Vec3d(m_inverse_rows[0].dot(v), m_inverse_rows[1].dot(v), m_inverse_rows[2].dot(v));
  };
  m_xy = precondition(m_xy);
  m_yz = precondition(m_yz);
  m_xz = precondition(m_xz);
  m_xyz = precondition(m_xyz);

  // The row sums of N' on a box larger than the cell: below 1 the map is injective there.
  const Vec3d pairs = abs(m_xy) + abs(m_yz) + abs(m_xz);
  constexpr double kHalf = kInjectiveHalf;
  m_bend = max_component(pairs + abs(m_xyz) * 7.0);
  m_injective = max_component(pairs * (2 * kHalf) + abs(m_xyz) * (3 * kHalf * kHalf)) < 1;

  // The image lies in the box of its corners: with the signs of x and y fixed, those along z.
  for (int a = 0; a < 3; ++a) {
    const double half = a == 2 ? 0.5 : 0;
    double lo[4], hi[4];
    for (int n = 0; n < 4; ++n) {
      const double x = n & 2 ? 0.5 : -0.5, y = n & 1 ? 0.5 : -0.5;
      const double middle = (a == 0 ? x : a == 1 ? y : 0) + m_xy[a] * (x * y);
      const double slope = half + 0.5 * (m_yz[a] * y + m_xz[a] * x + m_xyz[a] * (x * y));
      lo[n] = middle - std::abs(slope);
      hi[n] = middle + std::abs(slope);
    }
    m_lo[a] = std::min(std::min(lo[0], lo[1]), std::min(lo[2], lo[3])) - kEdge;
    m_hi[a] = std::max(std::max(hi[0], hi[1]), std::max(hi[2], hi[3])) + kEdge;
  }
}

DeformedCell::Target DeformedCell::target_of(const Vec3d& x, double tolerance,
                                             int max_steps) const {
  const Vec3d d = x - m_center;
  return {{m_inverse_rows[0].dot(d), m_inverse_rows[1].dot(d), m_inverse_rows[2].dot(d)},
          kNewtonPart * tolerance / m_scale,
          max_steps};
}

inline Vec3d DeformedCell::value(const Vec3d& eta) const {
  Vec3d sum = eta + m_xy * (eta.x * eta.y) + m_yz * (eta.y * eta.z) + m_xz * (eta.x * eta.z) +
              m_xyz * (eta.x * eta.y * eta.z);
  if (m_singular) sum += m_rest[0] * eta.x + m_rest[1] * eta.y + m_rest[2] * eta.z;
  return sum;
}

/// Jacobian columns of the preconditioned map.
inline void DeformedCell::jacobian(const Vec3d& eta, Vec3d& jx, Vec3d& jy, Vec3d& jz) const {
  jx = m_xy * eta.y + m_xz * eta.z + m_xyz * (eta.y * eta.z);
  jy = m_xy * eta.x + m_yz * eta.z + m_xyz * (eta.x * eta.z);
  jz = m_yz * eta.y + m_xz * eta.x + m_xyz * (eta.x * eta.y);
  jx.x += 1;
  jy.y += 1;
  jz.z += 1;
  if (m_singular) {
    jx += m_rest[0];
    jy += m_rest[1];
    jz += m_rest[2];
  }
}

inline bool DeformedCell::newton(const Target& target, Vec3d& eta) const {
  for (int step = 0; step <= target.max_steps; ++step) {
    const Vec3d residual = value(eta) - target.t;
    if (max_abs(residual) <= target.tolerance) return true;
    Vec3d jx, jy, jz;
    jacobian(eta, jx, jy, jz);
    const Vec3d change = newton_step(jx, jy, jz, residual);
    eta = clamp(eta - change, 2);
    // The residual after a step is of second order in it; often that saves another look.
    const double size = max_abs(change);
    if (!m_singular && size < 1 && m_bend * size * size <= target.tolerance) return true;
  }
  return false;
}

DeformedCell::Outcome DeformedCell::solve(const Vec3d& x, double tolerance, int max_steps,
                                          Vec3d& local) const {
  if (m_singular) return Outcome::undecided;
  const Target target = target_of(x, tolerance, max_steps);
  for (int a = 0; a < 3; ++a) {
    if (target.t[a] < m_lo[a] || target.t[a] > m_hi[a]) return Outcome::outside;
  }
  if (m_folded) return Outcome::undecided;
  Vec3d eta = clamp(target.t, 0.5);
  if (!newton(target, eta)) return Outcome::undecided;
  const double reached = max_abs(eta);
  if (reached <= 0.5 + kEdge) {
    local = clamp(eta, 0.5) + Vec3d(0.5);
    return Outcome::inside;
  }
  return m_injective && reached <= kInjectiveHalf ? Outcome::outside : Outcome::undecided;
}

DeformedCell::Outcome DeformedCell::solve_by_bisection(const Vec3d& x, double tolerance,
                                                       int max_steps, Vec3d& local) const {
  const Target target = target_of(x, tolerance, max_steps);
  Search search{target, x, {}};
  bisect(search, Vec3d(-0.5), Vec3d(0.5), 0);
  if (search.best_squared >= 0) {
    local = search.best;
    return Outcome::inside;
  }
  return search.undecided ? Outcome::undecided : Outcome::outside;
}

/// True when the map is shown to be injective on a box: its Jacobian, times the inverse of that in
/// the middle, stays within a row sum of 1 of the unit matrix.
bool DeformedCell::is_injective(const Vec3d& middle, const Vec3d& half) const {
  Vec3d jx, jy, jz;
  jacobian(middle, jx, jy, jz);
  const Vec3d yz = jy.cross(jz);
  const double volume = jx.dot(yz);
  if (!(std::abs(volume) > kRegular)) return false;
  const Vec3d rows[3] = {yz / volume, jz.cross(jx) / volume, jx.cross(jy) / volume};
  // Largest change of each column over the box, component by component.
  const Vec3d xy = abs(m_xy + m_xyz * middle.z), yz_bend = abs(m_yz + m_xyz * middle.x),
              xz = abs(m_xz + m_xyz * middle.y), xyz = abs(m_xyz);
  const Vec3d change_x = xy * half.y + xz * half.z + xyz * (half.y * half.z);
  const Vec3d change_y = xy * half.x + yz_bend * half.z + xyz * (half.x * half.z);
  const Vec3d change_z = yz_bend * half.y + xz * half.x + xyz * (half.x * half.y);
  const Vec3d change = change_x + change_y + change_z;
  return std::max({abs(rows[0]).dot(change), abs(rows[1]).dot(change), abs(rows[2]).dot(change)}) <
         1;
}

void DeformedCell::bisect(Search& search, const Vec3d& lo, const Vec3d& hi, int depth) const {
  if (search.best_squared >= 0) {
    // One solution is enough without folds; with them only a shorter offset is of interest.
    if (!m_folded) return;
    const Vec3d start = search.x - Vec3d(0.5);
    const Vec3d nearest(std::clamp(start.x, lo.x, hi.x), std::clamp(start.y, lo.y, hi.y),
                        std::clamp(start.z, lo.z, hi.z));
    if ((nearest - start).length2() >= search.best_squared) return;
  }
  if (++search.boxes > kMaxBoxes) {
    search.undecided = true;
    return;
  }

  // No solution in the box when the hull of its image misses the target.
  Vec3d image_lo = value(lo), image_hi = image_lo;
  for (int n = 1; n < 8; ++n) {
    const Vec3d image = value({n & 4 ? hi.x : lo.x, n & 2 ? hi.y : lo.y, n & 1 ? hi.z : lo.z});
    for (int a = 0; a < 3; ++a) {
      image_lo[a] = std::min(image_lo[a], image[a]);
      image_hi[a] = std::max(image_hi[a], image[a]);
    }
  }
  const double slack = kEdge + search.target.tolerance;
  for (int a = 0; a < 3; ++a) {
    if (search.target.t[a] < image_lo[a] - slack || search.target.t[a] > image_hi[a] + slack) {
      return;
    }
  }

  // Newton from the middle of the box may end anywhere in the cell.
  const Vec3d middle = (lo + hi) * 0.5;
  Vec3d eta = middle;
  const bool converged = newton(search.target, eta);
  if (converged && max_abs(eta) <= 0.5 + kEdge) {
    const Vec3d local = clamp(eta, 0.5) + Vec3d(0.5);
    const double squared = (local - search.x).length2();
    if (search.best_squared < 0 || squared < search.best_squared) {
      search.best = local;
      search.best_squared = squared;
    }
  }
  const auto is_in_box = [&](const Vec3d& v) {
    for (int a = 0; a < 3; ++a) {
      if (v[a] < lo[a] || v[a] > hi[a]) return false;
    }
    return true;
  };
  if (converged && is_in_box(eta) && is_injective(middle, hi - middle)) return;
  if (depth == kMaxDepth) {
    search.undecided = search.undecided || !converged;
    return;
  }
  for (int n = 0; n < 8; ++n) {
    const Vec3d from(n & 4 ? middle.x : lo.x, n & 2 ? middle.y : lo.y, n & 1 ? middle.z : lo.z);
    bisect(search, from, from + (hi - lo) * 0.5, depth + 1);
  }
}

}  // namespace supple
