// Leaving out parts of a picture. A region is convex, an intersection of half-spaces; a clip keeps
// its inside or its outside. In the deformed space it cuts the picture, whatever tissue lies there;
// in the source space it cuts the tissue, and the cut moves along with it. Rays in index space are
// here, too.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "volumes/base/vec.h"
#include "volumes/geometry/geometry.h"

namespace supple {

/// A ray in index space: origin + t * direction, t in mm.
struct IndexRay {
  Vec3d origin;
  Vec3d direction;
  Vec3d at(double t) const { return origin + direction * t; }
};

/// The end of a ray that nothing ends.
constexpr double kEndless = std::numeric_limits<double>::infinity();

struct Interval {
  double begin, end;
};

/// Part of the ray's [begin, end] inside the box lo … hi; empty (begin > end) when it misses.
Interval clip_to_box(const IndexRay& ray, const Vec3d& lo, const Vec3d& hi, Interval within);

/// Inside where (x - point) . normal >= 0; LPS mm, any length of the normal but 0.
struct HalfSpace {
  Vec3d point_lps_mm;
  Vec3d normal_lps;
};

enum class ClipSpace { source, deformed };
enum class ClipKeep { inside, outside };

struct Clip {
  std::vector<HalfSpace> region;
  ClipKeep keep = ClipKeep::inside;
  ClipSpace space = ClipSpace::deformed;

  /// Throws InputError: no half-space, a point or normal that is not finite, a normal of length 0.
  void validate(const std::string& file) const;
};

/// The six half-spaces of a box between two corners in index space, in any order.
std::vector<HalfSpace> box_region(const Geometry& geometry, const Vec3d& corner,
                                  const Vec3d& opposite);

/// A clip in index space.
class IndexClip {
 public:
  IndexClip(const Clip& clip, const Geometry& geometry);

  bool keeps(const Vec3d& x) const { return contains(x) == (m_keep == ClipKeep::inside); }
  ClipKeep keep() const { return m_keep; }
  ClipSpace space() const { return m_space; }
  /// The part of the ray inside the region; empty (begin > end) when it misses.
  Interval along(const IndexRay& ray) const;

  struct Plane {
    Vec3d normal;     // covector: mm per voxel
    double distance;  // inside: normal . x >= distance
    double depth_mm(const Vec3d& x) const { return normal.dot(x) - distance; }
  };

  /// The face by which a ray entered the kept part before it reached x, and how many mm ago; null
  /// when it came by none. `rate(normal)` is the depth, mm, that it gains per mm.
  template <class Rate>
  const Plane* face_behind(const Vec3d& x, Rate&& rate, double& mm_ago) const {
    const bool is_inside = m_keep == ClipKeep::inside;
    const Plane* face = nullptr;
    for (const Plane& plane : m_planes) {
      const double gain = rate(plane.normal);
      if (is_inside ? gain <= 0 : gain >= 0) continue;
      // Into a convex region a ray comes by the plane that it crosses last, out by the first.
      const double ago = plane.depth_mm(x) / gain;
      if (face != nullptr && (is_inside ? ago >= mm_ago : ago <= mm_ago)) continue;
      face = &plane;
      mm_ago = ago;
    }
    if (face == nullptr || is_inside) return face;
    if (mm_ago < 0) return nullptr;  // still to come
    // A ray that passes by the region crosses planes, too.
    for (const Plane& plane : m_planes) {
      if (plane.depth_mm(x) - mm_ago * rate(plane.normal) < -kPassesByMm) return nullptr;
    }
    return face;
  }

 private:
  static constexpr double kPassesByMm = 1e-3;

  bool contains(const Vec3d& x) const;

  std::vector<Plane> m_planes;
  ClipKeep m_keep;
  ClipSpace m_space;
};

}  // namespace supple
