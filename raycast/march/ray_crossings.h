// Meetings of a ray beside tissue: the parts that clips of the deformed space leave, and its
// crossings with meshes, one after another.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "raycast/march/surface_scene.h"
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
