// The crossings of a ray with meshes, one after another.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "raycast/march/ray_clips.h"
#include "raycast/march/surface_scene.h"

namespace supple {

class RayCrossings {
 public:
  /// `surfaces` null: none. `clips` null: they leave meshes whole.
  void begin_ray(const SurfaceScene* surfaces, const Ray& ray, const RayClips* clips);

  /// Distance of the next crossing along the ray, mm; infinite when there is none.
  double next_t() const { return m_next_t; }
  std::size_t next() const { return m_next; }
  const TriangleHit& hit(std::size_t n) const { return m_hits[n]; }
  void pass();
  /// Distance of the first opaque crossing, mm; infinite when there is none.
  double opaque_t() const { return m_opaque_t; }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  std::vector<TriangleHit> m_hits;  // ascending
  std::size_t m_next = 0;
  double m_next_t = kNever, m_opaque_t = kNever;
};

}  // namespace supple
