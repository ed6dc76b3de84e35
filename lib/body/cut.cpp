#include "lib/body/cut.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "volumes/base/error.h"

namespace supple {

namespace {

// Coordinates below 2^41 units: edge functions stay below 2^85, their products with a coordinate
// below 2^126.
constexpr std::int64_t kOne = std::int64_t(1) << 24;
constexpr double kMaxVoxel = 131071;
__extension__ using Wide = __int128;

/// Shift of all vertices in 2^-24 voxel; no small integer combination of the three is 0.
constexpr std::array<std::int64_t, 3> kShift = {499, 557, 619};

using FixedPoint = std::array<std::int64_t, 3>;
using FixedTriangle = std::array<FixedPoint, 3>;

FixedPoint fixed_point(const Geometry& geometry, const Vec3d& vertex_lps_mm) {
  const Vec3d index = geometry.index_from_world(vertex_lps_mm);
  FixedPoint point;
  for (int a = 0; a < 3; ++a) {
    if (!(std::abs(index[a]) <= kMaxVoxel)) {
      throw InputError({"", std::string("cut surface along axis ") + "ijk"[a],
                        "a vertex at voxel " + number_text(index[a]),
                        "a finite place within +-131071 voxels"});
    }
    point[a] = std::llround(index[a] * double(kOne)) + kShift[a];
  }
  return point;
}

Wide cross(const FixedPoint& a, const FixedPoint& b, const FixedPoint& c, int u, int v) {
  return Wide(b[u] - a[u]) * (c[v] - a[v]) - Wide(b[v] - a[v]) * (c[u] - a[u]);
}

std::int64_t floor_divide(Wide numerator, Wide positive) {
  const Wide quotient = numerator / positive;
  return std::int64_t(quotient - (quotient * positive > numerator ? 1 : 0));
}

/// Integers from the first at or above `lo` to the last at or below `hi`, within bounds.
struct SlotRange {
  int first, last;
};
SlotRange lattice_range(std::int64_t lo, std::int64_t hi, int bound_lo, int bound_hi) {
  const std::int64_t first = -floor_divide(-lo, kOne), last = floor_divide(hi, kOne);
  return {int(std::max<std::int64_t>(first, bound_lo)),
          int(std::min<std::int64_t>(last, bound_hi))};
}

/// Marks the links of one axis that triangles cross: lattice lines along the axis, which appear as
/// points (u, v) of its projection.
class AxisCutter {
 public:
  AxisCutter(const BrickTopology& elements, int axis, LinkCuts& crossed)
      : m_elements(elements),
        m_axis(axis),
        m_u((axis + 1) % 3),
        m_v((axis + 2) % 3),
        m_crossed(crossed) {}

  /// Adds a triangle; false when it has no area in this projection: no line crosses its inside.
  bool add(FixedTriangle triangle) {
    const Wide area = cross(triangle[0], triangle[1], triangle[2], m_u, m_v);
    if (area == 0) return false;
    if (area < 0) std::swap(triangle[1], triangle[2]);
    const IndexBox& bounds = m_elements.active_bounds();
    const auto [lo, hi] = std::minmax({triangle[0][m_v], triangle[1][m_v], triangle[2][m_v]});
    const SlotRange rows = lattice_range(lo, hi, bounds.lo[m_v], bounds.hi[m_v]);
    for (int row = rows.first; row <= rows.last; ++row)
      add_row(triangle, area < 0 ? -area : area, row);
    return true;
  }

 private:
  void add_row(const FixedTriangle& triangle, Wide area, int row) {
    const SlotRange columns = columns_of(triangle, row);
    for (int column = columns.first; column <= columns.last; ++column) {
      FixedPoint point{};
      point[m_u] = column * kOne;
      point[m_v] = row * kOne;
      // Twice the areas opposite to each corner: barycentric coordinates times `area`.
      Wide along = 0;
      bool inside = true;
      for (int corner = 0; corner < 3 && inside; ++corner) {
        const Wide part =
            cross(triangle[(corner + 1) % 3], triangle[(corner + 2) % 3], point, m_u, m_v);
        inside = part >= 0;
        along += part * triangle[corner][m_axis];
      }
      if (!inside) continue;
      const std::int64_t low = floor_divide(along, area * kOne);
      const double fraction = double(along - low * (area * kOne)) / double(area * kOne);
      cross_link(column, row, low, LinkCuts::place_of(fraction));
    }
  }

  /// Columns that the triangle may cover in a row, by floating point: one more at both ends.
  SlotRange columns_of(const FixedTriangle& triangle, int row) const {
    const double v = double(row) * double(kOne);
    double lo = HUGE_VAL, hi = -HUGE_VAL;
    for (int n = 0; n < 3; ++n) {
      const FixedPoint& a = triangle[n];
      const FixedPoint& b = triangle[(n + 1) % 3];
      const double va = double(a[m_v]), vb = double(b[m_v]);
      if (std::min(va, vb) > v || std::max(va, vb) < v) continue;
      const double t = va == vb ? 0 : (v - va) / (vb - va);
      const double u = double(a[m_u]) + t * double(b[m_u] - a[m_u]);
      lo = std::min({lo, u, va == vb ? double(b[m_u]) : u});
      hi = std::max({hi, u, va == vb ? double(b[m_u]) : u});
    }
    const IndexBox& bounds = m_elements.active_bounds();
    return {std::max(bounds.lo[m_u], int(std::floor(lo / double(kOne))) - 1),
            std::min(bounds.hi[m_u], int(std::ceil(hi / double(kOne))) + 1)};
  }

  /// Marks the link that starts at `low`, if both its ends are elements.
  void cross_link(int column, int row, std::int64_t low, LinkCuts::Place place) {
    const IndexBox& bounds = m_elements.active_bounds();
    if (low < bounds.lo[m_axis] || low >= bounds.hi[m_axis]) return;
    Vec3i voxel;
    voxel[m_u] = column;
    voxel[m_v] = row;
    voxel[m_axis] = int(low);
    Slot slot, next;
    if (!slot_of(m_elements, voxel, slot)) return;
    if (!neighbour_slot(m_elements, LinkCuts{}, slot, m_axis, true, next)) return;
    m_crossed.cut(slot / kBrickVoxels, int(slot % kBrickVoxels), m_axis, place);
  }

  const BrickTopology& m_elements;
  const int m_axis, m_u, m_v;
  LinkCuts& m_crossed;
};

/// The patch with its edges moved outwards by more than the shift of its vertices, so that it cuts
/// the lattice lines through them.
PlanePatch with_margin(const PlanePatch& patch, const Geometry& geometry) {
  constexpr double kMargin = 1e-4;  // voxels
  const Vec3d edge1 = geometry.index_vector_from_world(patch.edge1_lps_mm);
  const Vec3d edge2 = geometry.index_vector_from_world(patch.edge2_lps_mm);
  const double area = edge1.cross(edge2).length();
  if (!(area > 0)) return patch;
  // The margin over the heights of the parallelogram.
  const double part1 = kMargin * edge2.length() / area, part2 = kMargin * edge1.length() / area;
  return {patch.corner_lps_mm - patch.edge1_lps_mm * part1 - patch.edge2_lps_mm * part2,
          patch.edge1_lps_mm * (1 + 2 * part1), patch.edge2_lps_mm * (1 + 2 * part2)};
}

/// Adds the crossed links to the cuts of the body.
CutReport merge(const LinkCuts& crossed, Body& body) {
  CutReport report;
  report.crossed = crossed.count();
  for (std::size_t b = 0; b < crossed.brick_end(); ++b) {
    const LinkCuts::BrickCuts* links = crossed.brick(b);
    for (int axis = 0; links != nullptr && axis < 3; ++axis) {
      for_each_active((*links)[axis], [&](int offset) {
        report.newly_cut += body.cuts.cut(b, offset, axis, crossed.place(b, offset, axis));
      });
    }
  }
  return report;
}

}  // namespace

CutReport cut(Body& body, const TriangleMesh& surface) {
  std::vector<FixedPoint> points;
  points.reserve(surface.vertices_lps_mm.size());
  for (const Vec3d& vertex : surface.vertices_lps_mm) {
    points.push_back(fixed_point(body.geometry, vertex));
  }
  LinkCuts crossed;
  std::array<AxisCutter, 3> cutters = {AxisCutter(body.elements, 0, crossed),
                                       AxisCutter(body.elements, 1, crossed),
                                       AxisCutter(body.elements, 2, crossed)};
  std::int64_t degenerate = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    const FixedTriangle triangle = {points[std::size_t(a)], points[std::size_t(b)],
                                    points[std::size_t(c)]};
    bool has_area = false;
    for (AxisCutter& cutter : cutters) has_area = cutter.add(triangle) || has_area;
    degenerate += !has_area;
  }
  CutReport report = merge(crossed, body);
  report.degenerate = degenerate;
  return report;
}

CutReport cut(Body& body, const PlanePatch& patch) {
  const PlanePatch grown = with_margin(patch, body.geometry);
  const Vec3d& corner = grown.corner_lps_mm;
  const Vec3d far1 = corner + grown.edge1_lps_mm, far2 = corner + grown.edge2_lps_mm;
  return cut(body,
             TriangleMesh{{corner, far1, far2, far1 + grown.edge2_lps_mm}, {{0, 1, 2}, {1, 3, 2}}});
}

CutReport cut_boundary(Body& body, const std::function<bool(Slot)>& inside) {
  return cut_links(body, [&](Slot low, Slot high) { return inside(low) != inside(high); });
}

CutReport cut_links(Body& body, const std::function<bool(Slot low, Slot high)>& parts) {
  LinkCuts crossed;
  const LinkCuts none;
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    for_each_link(body.elements, none, b, [&](int axis, Slot low, Slot high) {
      if (parts(low, high)) crossed.cut(b, int(low % kBrickVoxels), axis);
    });
  }
  return merge(crossed, body);
}

}  // namespace supple
