// Parts of a ray that the clips of the deformed space, which cut the picture, leave.
#pragma once

#include <vector>

#include "raycast/scene/clip.h"

namespace supple {

class RayClips {
 public:
  void begin_ray(const std::vector<IndexClip>& clips, const IndexRay& ray);
  /// Outside of it everything is clipped, and parts of it may be.
  const Interval& kept() const { return m_kept; }
  bool is_clipped(double t) const;

 private:
  Interval m_kept{};
  std::vector<Interval> m_removed;
};

}  // namespace supple
