#include "raycast/march/ray_crossings.h"

#include <algorithm>

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

}  // namespace supple
