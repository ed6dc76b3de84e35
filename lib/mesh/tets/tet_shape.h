// Edges and angles of one tetrahedron.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "volumes/base/units.h"
#include "volumes/base/vec.h"

namespace supple {

inline constexpr int kTetEdges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
/// The edge between two corners.
inline constexpr int kEdgeBetween[4][4] = {
    {-1, 0, 1, 2}, {0, -1, 3, 4}, {1, 3, -1, 5}, {2, 4, 5, -1}};

inline double tet_volume(const std::array<Vec3d, 4>& p) {
  return (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) / 6;
}

/// Cosines of the dihedral angles of a tetrahedron of positive volume.
struct TetAngles {
  double least_cosine = 1, largest_cosine = -1;
  std::array<double, 4> areas{};  // of the face opposite to each corner

  explicit TetAngles(const std::array<Vec3d, 4>& p) {
    const std::array<Vec3d, 4> normals = {
        (p[3] - p[1]).cross(p[2] - p[1]), (p[2] - p[0]).cross(p[3] - p[0]),
        (p[3] - p[0]).cross(p[1] - p[0]), (p[1] - p[0]).cross(p[2] - p[0])};
    std::array<double, 4> lengths{};
    for (std::size_t f = 0; f < 4; ++f) {
      lengths[f] = normals[f].length();
      areas[f] = lengths[f] / 2;
    }
    for (const auto& [a, b] : kTetEdges) {
      const std::size_t i = std::size_t(a), j = std::size_t(b);
      const double cosine = -normals[i].dot(normals[j]) / (lengths[i] * lengths[j]);
      least_cosine = std::min(least_cosine, cosine);
      largest_cosine = std::max(largest_cosine, cosine);
    }
  }
};

inline double angle_deg(double cosine) {
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * kDegreesPerRadian;
}

}  // namespace supple
