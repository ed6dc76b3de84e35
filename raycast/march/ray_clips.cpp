#include "raycast/march/ray_clips.h"

#include <algorithm>
#include <limits>

namespace supple {

void RayClips::begin_ray(const std::vector<IndexClip>& clips, const IndexRay& ray) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  m_kept = {-kInfinity, kInfinity};
  m_removed.clear();
  for (const IndexClip& clip : clips) {
    const Interval part = clip.along(ray);
    if (clip.keep() == ClipKeep::outside) {
      if (part.begin <= part.end) m_removed.push_back(part);
      continue;
    }
    m_kept = {std::max(m_kept.begin, part.begin), std::min(m_kept.end, part.end)};
  }
}

bool RayClips::is_clipped(double t) const {
  if (t < m_kept.begin || t > m_kept.end) return true;
  return std::any_of(m_removed.begin(), m_removed.end(), [t](const Interval& removed) {
    return t >= removed.begin && t <= removed.end;
  });
}

}  // namespace supple
