#include "raycast/march/ray_crossings.h"

#include <algorithm>
#include <limits>

namespace supple {

void RayCrossings::begin_ray(const SurfaceScene* surfaces, const Ray& ray, const RayClips* clips) {
  m_next = 0;
  m_next_t = m_opaque_t = kNever;
  if (surfaces == nullptr) return;
  surfaces->crossings(ray, {0, kNever}, m_hits);
  if (clips != nullptr) {
    m_hits.erase(std::remove_if(m_hits.begin(), m_hits.end(),
                                [&](const TriangleHit& hit) { return clips->is_clipped(hit.t); }),
                 m_hits.end());
  }
  if (m_hits.empty()) return;
  m_next_t = m_hits.front().t;
  for (const TriangleHit& hit : m_hits) {
    if (surfaces->opacity(hit) < 1) continue;
    m_opaque_t = hit.t;
    break;
  }
}

void RayCrossings::pass() {
  ++m_next;
  m_next_t = m_next < m_hits.size() ? m_hits[m_next].t : kNever;
}

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
