// Parts of a ray that the clips of the deformed space, which cut the picture, leave.
#pragma once

#include <vector>

#include "raycast/scene/clip.h"

namespace supple {

class RayClips {
 public:
  void begin_ray(const std::vector<IndexClip>& clips, const IndexRay& ray);
  /// The interval outside of which everything is clipped; parts of it may be clipped, too.
  const Interval& kept() const { return m_kept; }
  bool is_clipped(double t) const;

 private:
  Interval m_kept{};
  std::vector<Interval> m_removed;
};

}  // namespace supple
