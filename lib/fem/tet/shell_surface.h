// The nearest place on a surface of triangles for points that move along it: the search goes from
// triangle to triangle from where it ended last.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/fem/tet/block_csr.h"
#include "volumes/base/vec.h"

namespace supple {

class ShellSurface {
 public:
  struct Place {
    Vec3d point{0, 0, 0}, normal{0, 0, 0};  // the normal interpolated between corners
    std::int32_t triangle = 0;
  };
  /// Triangles between positions, seen from outside counterclockwise.
  ShellSurface(const std::vector<Vec3d>& positions,
               const std::vector<std::array<NodeIndex, 3>>& triangles);

  /// The place nearest to x among those to which a search from a triangle leads.
  Place nearest(const Vec3d& x, std::int32_t from) const;
  /// A triangle at a node; -1 where it has none.
  std::int32_t triangle_at(NodeIndex node) const;
  /// Mean of the normals around a node by area, of length 1.
  const Vec3d& normal_at(NodeIndex node) const { return m_normals[std::size_t(node)]; }
  /// A third of the areas around a node.
  double area_at(NodeIndex node) const { return m_areas[std::size_t(node)]; }

 private:
  std::vector<Vec3d> m_positions;
  std::vector<std::array<NodeIndex, 3>> m_triangles;
  std::vector<Vec3d> m_normals;
  std::vector<double> m_areas;
  NodeSets m_corners;
  SetsOfNodes m_around;
};

}  // namespace supple
