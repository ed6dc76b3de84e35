#include "volumes/field/inversion/cell_corners.h"

#include <algorithm>
#include <array>

namespace supple {

namespace {

double triple(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return a.dot(b.cross(c));
}

/// Barycentric test with a tolerance relative to the tetrahedron.
bool in_tetrahedron(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d,
                    const Vec3d& x) {
  const Vec3d e1 = b - a, e2 = c - a, e3 = d - a, p = x - a;
  const double volume = triple(e1, e2, e3);
  if (volume == 0) return false;
  const double l1 = triple(p, e2, e3) / volume, l2 = triple(e1, p, e3) / volume,
               l3 = triple(e1, e2, p) / volume;
  return std::min({l1, l2, l3, 1 - l1 - l2 - l3}) >= -1e-12;
}

/// A polynomial of degree 2 along every axis, in Bernstein's basis on the cell: [x][y][z].
using DetCoefficients = std::array<std::array<std::array<double, 3>, 3>, 3>;

/// Coefficients of det(I + grad u): products of edges, each of degree 1 along the two other axes.
DetCoefficients det_coefficients(const CellCorners& corners) {
  Vec3d ex[2][2], ey[2][2], ez[2][2];  // by the two other axes
  for (int n = 0; n < 4; ++n) {
    const int m = n >> 1, k = n & 1;
    ex[m][k] = corners.corner(4 + n) - corners.corner(n);
    ey[m][k] = corners.corner(4 * m + 2 + k) - corners.corner(4 * m + k);
    ez[m][k] = corners.corner(2 * n + 1) - corners.corner(2 * n);
  }
  constexpr double kShare[3] = {1, 0.5, 1};  // one over the binomials
  DetCoefficients d{};
  for (int n = 0; n < 16; ++n) {
    const int xy = n & 1, zy = n >> 1 & 1, xz = n >> 2 & 1, yz = n >> 3;
    const Vec3d normal = ey[xy][zy].cross(ez[xz][yz]) * kShare[xy + xz];
    for (int y = 0; y < 2; ++y) {
      for (int z = 0; z < 2; ++z) {
        d[xy + xz][y + yz][z + zy] += ex[y][z].dot(normal) * (kShare[y + yz] * kShare[z + zy]);
      }
    }
  }
  return d;
}

/// The half of a polynomial below or above the middle along an axis, by de Casteljau.
DetCoefficients half_of(const DetCoefficients& d, int axis, bool upper) {
  DetCoefficients half;
  for (int m = 0; m < 3; ++m) {
    for (int n = 0; n < 3; ++n) {
      const auto at = [&](auto& of, int k) -> auto& {
        return axis == 0 ? of[k][m][n] : axis == 1 ? of[m][k][n] : of[m][n][k];
      };
      const double low = at(d, 0), middle = at(d, 1), high = at(d, 2);
      const double centre = (low + 2 * middle + high) / 4;
      at(half, upper ? 2 : 0) = upper ? high : low;
      at(half, 1) = ((upper ? high : low) + middle) / 2;
      at(half, upper ? 0 : 2) = centre;
    }
  }
  return half;
}

constexpr int kMaxFoldDepth = 18;  // six halvings along every axis

bool has_zero(const DetCoefficients& d, int depth) {
  bool is_positive = true;
  for (int n = 0; n < 27 && is_positive; ++n) is_positive = d[n / 9][n / 3 % 3][n % 3] > 0;
  if (is_positive) return false;
  for (int n = 0; n < 8; ++n) {
    if (d[n & 4 ? 2 : 0][n & 2 ? 2 : 0][n & 1 ? 2 : 0] <= 0) return true;
  }
  return depth == kMaxFoldDepth || has_zero(half_of(d, depth % 3, false), depth + 1) ||
         has_zero(half_of(d, depth % 3, true), depth + 1);
}

}  // namespace

double min_corner_det(const CellCorners& corners) {
  // Edges along x, y, z at every corner, component by component so that the loops vectorise.
  double edge[3][3][8];
  for (int a = 0; a < 3; ++a) {
    const auto& p = corners.p[a];
    for (int n = 0; n < 8; ++n) {
      edge[0][a][n] = p[n | 4] - p[n & ~4];
      edge[1][a][n] = p[n | 2] - p[n & ~2];
      edge[2][a][n] = p[n | 1] - p[n & ~1];
    }
  }
  double dets[8];
  for (int n = 0; n < 8; ++n) {
    const auto e = [&](int axis, int a) { return edge[axis][a][n]; };
    dets[n] = e(0, 0) * (e(1, 1) * e(2, 2) - e(1, 2) * e(2, 1)) -
              e(1, 0) * (e(0, 1) * e(2, 2) - e(0, 2) * e(2, 1)) +
              e(2, 0) * (e(0, 1) * e(1, 2) - e(0, 2) * e(1, 1));
  }
  return *std::min_element(dets, dets + 8);
}

bool is_folded(const CellCorners& corners) {
  return min_corner_det(corners) <= 0 || has_zero(det_coefficients(corners), 0);
}

bool covered_by_tetrahedra(const CellCorners& corners, const Vec3d& x) {
  // Paths from corner 0 to corner 7 along the axes in every order.
  constexpr int kPaths[6][2] = {{4, 6}, {4, 5}, {2, 6}, {2, 3}, {1, 5}, {1, 3}};
  for (const auto& path : kPaths) {
    if (in_tetrahedron(corners.corner(0), corners.corner(path[0]), corners.corner(path[1]),
                       corners.corner(7), x)) {
      return true;
    }
  }
  return false;
}

}  // namespace supple
