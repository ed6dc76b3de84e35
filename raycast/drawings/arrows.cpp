#include "raycast/drawings/arrows.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr double kShortest = 1.0 / 50;  // of the distance between arrows, and so the next
constexpr double kShaftRadius = 1.0 / 16, kHeadRadius = 1.0 / 6, kHeadLength = 0.45;
constexpr double kMostPlaces = 1e6;
constexpr int kRingPoints = 8;
constexpr double kAroundRing = 6.283185307179586;

/// Rings of vertices about an axis, joined to a closed skin.
class Turned {
 public:
  Turned(TriangleMesh& mesh, const Vec3d& origin, const Vec3d& axis)
      : m_mesh(mesh), m_origin(origin), m_axis(axis) {
    const Vec3d aside = std::abs(axis.x) < 0.7 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
    m_first = axis.cross(aside).normalized();
    m_second = axis.cross(m_first);
  }

  /// A ring `along` the axis; radius 0: a point, but as many vertices.
  void ring(double along, double radius) {
    const int begin = int(m_mesh.vertices_lps_mm.size());
    for (int n = 0; n < kRingPoints; ++n) {
      const double angle = kAroundRing * n / kRingPoints;
      m_mesh.vertices_lps_mm.push_back(m_origin + m_axis * along +
                                       (m_first * std::cos(angle) + m_second * std::sin(angle)) *
                                           radius);
    }
    if (m_last >= 0) join(m_last, begin);
    m_last = begin;
  }

 private:
  /// Outwards counter-clockwise; triangles at a point have no area and are left out by surfaces.
  void join(int lower, int upper) {
    for (int n = 0; n < kRingPoints; ++n) {
      const int next = (n + 1) % kRingPoints;
      m_mesh.triangles.push_back({lower + n, lower + next, upper + next});
      m_mesh.triangles.push_back({lower + n, upper + next, upper + n});
    }
  }

  TriangleMesh& m_mesh;
  Vec3d m_origin, m_axis, m_first, m_second;
  int m_last = -1;
};

void add_arrow(const Arrow& arrow, double apart_mm, TriangleMesh& mesh) {
  const Vec3d way = arrow.to_lps_mm - arrow.from_lps_mm;
  const double length = way.length();
  // A short arrow is all head, and smaller.
  const double head = std::min(kHeadLength * apart_mm, length);
  const double size = apart_mm * head / (kHeadLength * apart_mm);
  const double neck = length - head;
  Turned skin(mesh, arrow.from_lps_mm, way / length);
  skin.ring(0, 0);
  if (neck > 0) {
    skin.ring(0, kShaftRadius * size);
    skin.ring(neck, kShaftRadius * size);
  }
  skin.ring(neck, kHeadRadius * size);
  skin.ring(length, 0);
}

}  // namespace

std::vector<Arrow> arrows_on_lattice(const Geometry& geometry, double apart_mm,
                                     const ArrowAt& arrow_at) {
  Vec3d step(0), first(0);
  double places = 1;
  std::array<int, 3> counts;
  for (int a = 0; a < 3; ++a) {
    step[a] = apart_mm / geometry.spacing_mm()[a];
    const double count = std::max(1.0, std::floor(geometry.dims()[a] / step[a]));
    places *= count;
    counts[std::size_t(a)] = int(std::min(count, kMostPlaces));
    first[a] = 0.5 * (geometry.dims()[a] - 1 - (count - 1) * step[a]);
  }
  if (places > kMostPlaces) {
    throw InputError({"", "arrows", number_text(apart_mm) + " mm, more than a million places",
                      "a larger distance"});
  }
  std::vector<Arrow> arrows;
  for (int k = 0; k < counts[2]; ++k) {
    for (int j = 0; j < counts[1]; ++j) {
      for (int i = 0; i < counts[0]; ++i) {
        const Vec3d index(first.x + i * step.x, first.y + j * step.y, first.z + k * step.z);
        Arrow arrow;
        if (!arrow_at(index, arrow)) continue;
        const double length = (arrow.to_lps_mm - arrow.from_lps_mm).length();
        if (length >= kShortest * apart_mm) arrows.push_back(arrow);
      }
    }
  }
  return arrows;
}

std::vector<Surface> arrow_surfaces(const std::vector<Arrow>& arrows, double apart_mm,
                                    double longest_mm,
                                    const std::function<Rgb(double share)>& colour) {
  std::vector<Surface> colours(kArrowColours);
  for (const Arrow& arrow : arrows) {
    const double length = (arrow.to_lps_mm - arrow.from_lps_mm).length();
    const int n = std::clamp(int(length / longest_mm * kArrowColours), 0, kArrowColours - 1);
    add_arrow(arrow, apart_mm, colours[std::size_t(n)].mesh);
  }
  std::vector<Surface> surfaces;
  for (int n = 0; n < kArrowColours; ++n) {
    Surface& surface = colours[std::size_t(n)];
    if (surface.mesh.triangles.empty()) continue;
    surface.rgb = colour((n + 0.5) / kArrowColours);
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
}

}  // namespace supple
