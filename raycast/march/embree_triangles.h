// Hits of rays on triangles: all hits of a ray in one traversal.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "raycast/march/embree_bounds.h"
#include "raycast/scene/camera.h"

namespace supple {

struct TriangleHit {
  double t;      // mm along the ray
  int triangle;  // index
  float u, v;    // weights of its second and third corner
};

class TriangleTree {
 public:
  /// Indices of vertices, LPS mm.
  TriangleTree(const std::vector<Vec3d>& vertices,
               const std::vector<std::array<int, 3>>& triangles);
  ~TriangleTree();
  TriangleTree(const TriangleTree&) = delete;
  TriangleTree& operator=(const TriangleTree&) = delete;

  /// Hits within the interval, ascending in t and index.
  void hits(const Ray& ray, Interval within, std::vector<TriangleHit>& out) const;
  /// Radius of the sphere around all triangles.
  double radius_mm() const;
  std::size_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace supple
