// Intervals in which rays can meet something visible: Embree user geometry over clusters of 2x2x2
// bricks, one all-hits traversal per ray (design.md section 5).
#pragma once

#include <memory>
#include <vector>

#include "raycast/scene/clip.h"
#include "volumes/grid/brick_topology.h"

namespace supple {

class VisibleBounds {
 public:
  /// `visible[b]`: brick b holds cells that may be visible.
  VisibleBounds(const BrickIndex& bricks, const std::vector<std::uint8_t>& visible);
  ~VisibleBounds();
  VisibleBounds(const VisibleBounds&) = delete;
  VisibleBounds& operator=(const VisibleBounds&) = delete;

  /// Intervals of the ray outside of which nothing is visible, ascending and disjoint.
  void intervals(const IndexRay& ray, Interval within, std::vector<Interval>& out) const;
  std::size_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace supple
