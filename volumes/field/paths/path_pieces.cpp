// Cut open and explode: pieces that move apart as rigid bodies.
#include <algorithm>

#include "volumes/base/error.h"
#include "volumes/field/paths/path_checks.h"
#include "volumes/field/paths/path_functions.h"

namespace supple {

namespace {

constexpr double kMaxGap_mm = 1e5;

/// Piece 0 lies where the normal points to.
class CutOpen : public PathFunction {
 public:
  explicit CutOpen(const CutOpenParams& params)
      : m_point(params.point), m_normal(unit_of("normal", params.normal)) {
    m_shift = m_normal * (params.gap_mm / 2);
    if (params.angle_degrees > 0) set_hinge(params);
  }
  int pieces() const override { return 2; }
  Vec3d forward(const Vec3d& from, int piece) const override {
    return moved(from, piece == 0 ? 1 : -1);
  }
  Vec3d backward(const Vec3d& at, int piece) const override {
    return moved(at, piece == 0 ? -1 : 1);
  }
  double depth_mm(const Vec3d& from, int piece) const override {
    const double depth = (from - m_point).dot(m_normal);
    return piece == 0 ? depth : -depth;
  }

 private:
  void set_hinge(const CutOpenParams& params) {
    require_finite("hinge", params.hinge);
    m_axis = unit_across("axis", params.hinge_axis, m_normal, "a direction in the plane");
    m_hinge = params.hinge - m_normal * (params.hinge - m_point).dot(m_normal);
    const Vec3d reach = m_point - m_hinge;
    const double arm = m_axis.cross(reach).dot(m_normal);
    require_path(std::abs(arm) > 1e-6, "hinge", "a hinge through the point",
                 "a point away from it, where the body is to open");
    m_half_angle = params.angle_degrees / 2 * kRadiansPerDegree * (arm > 0 ? 1 : -1);
  }
  Vec3d moved(const Vec3d& p, double sign) const {
    if (m_half_angle == 0) return p + m_shift * sign;
    return m_hinge + rotated(p - m_hinge, m_axis, m_half_angle * sign);
  }

  Vec3d m_point, m_normal, m_shift;
  Vec3d m_hinge{0, 0, 0}, m_axis{0, 0, 1};
  double m_half_angle = 0;
};

/// Piece (i, j, k) is number (i n_j + j) n_k + k.
class Explode : public PathFunction {
 public:
  Explode(const ExplodeParams& params, const Geometry& geometry)
      : m_geometry(geometry), m_grid(params.grid) {
    for (int a = 0; a < 3; ++a) {
      m_lo[a] = std::min(params.corner_index[a], params.opposite_index[a]);
      m_size[a] = std::abs(params.opposite_index[a] - params.corner_index[a]) / m_grid[a];
      Vec3d along(0);
      along[a] = 1;
      // One step leads through the planes between pieces by the gap, also on sheared grids.
      const Vec3d covector = geometry.world_gradient_from_index(along);
      m_mm[a] = 1 / covector.length();
      m_step[a] = geometry.axes_mm()[a] * (params.gap_mm * covector.length());
    }
  }
  int pieces() const override { return m_grid[0] * m_grid[1] * m_grid[2]; }
  Vec3d forward(const Vec3d& from, int piece) const override { return from + shift(piece); }
  Vec3d backward(const Vec3d& at, int piece) const override { return at - shift(piece); }
  double depth_mm(const Vec3d& from, int piece) const override {
    const Vec3d index = m_geometry.index_from_world(from);
    const std::array<int, 3> cell = cell_of(piece);
    double depth = HUGE_VAL;
    for (int a = 0; a < 3; ++a) {
      const double at = index[a] - m_lo[a];
      if (cell[a] > 0) depth = std::min(depth, (at - cell[a] * m_size[a]) * m_mm[a]);
      if (cell[a] < m_grid[a] - 1) {
        depth = std::min(depth, ((cell[a] + 1) * m_size[a] - at) * m_mm[a]);
      }
    }
    return depth;
  }

 private:
  std::array<int, 3> cell_of(int piece) const {
    return {piece / (m_grid[1] * m_grid[2]), piece / m_grid[2] % m_grid[1], piece % m_grid[2]};
  }
  Vec3d shift(int piece) const {
    const std::array<int, 3> cell = cell_of(piece);
    Vec3d sum(0);
    for (int a = 0; a < 3; ++a) sum += m_step[a] * (cell[a] - 0.5 * (m_grid[a] - 1));
    return sum;
  }

  Geometry m_geometry;
  std::array<int, 3> m_grid;
  Vec3d m_lo, m_size, m_mm;  // of the box, of a piece in voxels, mm between planes per voxel
  std::array<Vec3d, 3> m_step;
};

}  // namespace

std::shared_ptr<const PathFunction> make_cut_open(const CutOpenParams& params) {
  require_finite("point", params.point);
  require_between("gap", params.gap_mm, 0, kMaxGap_mm, "mm");
  require_between("angle", params.angle_degrees, 0, 180, "degrees");
  require_path(params.gap_mm == 0 || params.angle_degrees == 0, "gap", "gap and angle",
               "one of both");
  const auto function = std::make_shared<CutOpen>(params);
  if (params.gap_mm == 0 && params.angle_degrees == 0) return nullptr;
  return function;
}

std::shared_ptr<const PathFunction> make_explode(const ExplodeParams& params,
                                                 const Geometry& geometry) {
  require_between("gap", params.gap_mm, 0, kMaxGap_mm, "mm");
  long long pieces = 1;
  for (int a = 0; a < 3; ++a) {
    require_between("grid", params.grid[a], 1, 4096, "pieces along an axis");
    pieces *= params.grid[a];
    require_path(params.corner_index[a] != params.opposite_index[a], "box", "a box without volume",
                 "two corners that differ along every axis");
  }
  require_path(pieces <= 4096, "grid", std::to_string(pieces) + " pieces", "at most 4096");
  require_finite("box", params.corner_index);
  require_finite("box", params.opposite_index);
  if (pieces == 1 || params.gap_mm == 0) return nullptr;
  return std::make_shared<Explode>(params, geometry);
}

}  // namespace supple
