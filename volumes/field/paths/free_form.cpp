// Free-form deformation after Sederberg and Parry. The lattice moves the material, as in the
// thesis' three steps; the sampling path is its inverse, found by Newton's method with the analytic
// derivative. That it does not fold is checked when it is made, so there is one solution.
#include <algorithm>

#include "volumes/base/error.h"
#include "volumes/field/paths/path_checks.h"
#include "volumes/field/paths/path_functions.h"

namespace supple {

namespace {

constexpr int kMaxPoints = 10;
constexpr int kChecksPerPoint = 4;
constexpr int kMaxSteps = 60;
constexpr double kTolerance_mm = 1e-9, kSolved_mm = 1e-5;

using Weights = std::array<double, kMaxPoints>;

/// Bernstein polynomials of degree n - 1 at t, and their derivatives.
void bernstein(int n, double t, Weights& value, Weights& slope) {
  value.fill(0);
  value[0] = 1;
  // de Casteljau's recurrence; the slope comes from the degree below.
  for (int degree = 1; degree < n; ++degree) {
    if (degree == n - 1) {
      for (int i = 0; i < n; ++i) {
        slope[i] = degree * ((i > 0 ? value[i - 1] : 0) - (i < degree ? value[i] : 0));
      }
    }
    for (int i = degree; i > 0; --i) value[i] = (1 - t) * value[i] + t * value[i - 1];
    value[0] *= 1 - t;
  }
}

struct Jacobian {
  Vec3d columns[3] = {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)};
  double det() const { return columns[0].dot(columns[1].cross(columns[2])); }
  Vec3d solve(const Vec3d& b) const {
    const Vec3d& x = columns[0];
    const Vec3d& y = columns[1];
    const Vec3d& z = columns[2];
    return Vec3d(b.dot(y.cross(z)), x.dot(b.cross(z)), x.dot(y.cross(b))) / det();
  }
};

class FreeFormLattice : public PathFunction {
 public:
  FreeFormLattice(const LatticeParams& params, const Geometry& geometry)
      : m_geometry(geometry), m_points(params.points), m_moves(params.moves) {
    for (int a = 0; a < 3; ++a) {
      m_lo[a] = std::min(params.corner_index[a], params.opposite_index[a]);
      m_size[a] = std::abs(params.opposite_index[a] - params.corner_index[a]);
      Vec3d along(0);
      along[a] = 1 / m_size[a];
      m_gradient[a] = geometry.world_gradient_from_index(along);
    }
    refuse_folds();
  }

  Vec3d forward(const Vec3d& from, int) const override { return from + displacement(from); }

  Vec3d backward(const Vec3d& at, int) const override {
    const Vec3d u = displacement(at);
    if (u == Vec3d(0)) return at;
    Jacobian F;
    Vec3d from = at - u;
    Vec3d residual = from + displacement(from, &F) - at;
    for (int step = 0; step < kMaxSteps && residual.length() > kTolerance_mm; ++step) {
      const Vec3d change = F.solve(residual);
      // Newton's step, halved until it leads closer.
      double part = 1;
      for (int half = 0; half < 30; ++half, part /= 2) {
        Jacobian next_F;
        const Vec3d next = from - change * part;
        const Vec3d next_residual = next + displacement(next, &next_F) - at;
        if (!(next_residual.length() < residual.length())) continue;
        from = next;
        residual = next_residual;
        F = next_F;
        break;
      }
      if (part < 1e-8) break;
    }
    return residual.length() < kSolved_mm ? from : Vec3d(std::nan(""));
  }

 private:
  Vec3d displacement(const Vec3d& from, Jacobian* F = nullptr) const {
    const Vec3d local = (m_geometry.index_from_world(from) - m_lo) / m_size;
    std::array<bool, 3> is_clamped{};
    Vec3d t;
    for (int a = 0; a < 3; ++a) {
      t[a] = std::clamp(local[a], 0.0, 1.0);
      is_clamped[a] = t[a] != local[a];
    }
    return displacement_at(t, is_clamped, F);
  }

  Vec3d displacement_at(const Vec3d& t, const std::array<bool, 3>& is_clamped, Jacobian* F) const {
    Weights b[3], slope[3];
    for (int a = 0; a < 3; ++a) bernstein(m_points[a], t[a], b[a], slope[a]);
    Vec3d u(0), du[3] = {Vec3d(0), Vec3d(0), Vec3d(0)};
    for (const LatticeParams::Move& move : m_moves) {
      const auto& [i, j, k] = move.point;
      u += move.by_mm * (b[0][i] * b[1][j] * b[2][k]);
      if (F == nullptr) continue;
      du[0] += move.by_mm * (slope[0][i] * b[1][j] * b[2][k]);
      du[1] += move.by_mm * (b[0][i] * slope[1][j] * b[2][k]);
      du[2] += move.by_mm * (b[0][i] * b[1][j] * slope[2][k]);
    }
    for (int a = 0; F != nullptr && a < 3; ++a) {
      if (is_clamped[a]) continue;
      for (int c = 0; c < 3; ++c) F->columns[c] += du[a] * m_gradient[a][c];
    }
    return u;
  }

  /// Least determinant at t; at the faces of the box also that of the space beyond.
  double least_det(const Vec3d& t) const {
    double least = HUGE_VAL;
    for (int beyond = 0; beyond < 8; ++beyond) {
      std::array<bool, 3> is_clamped;
      bool exists = true;
      for (int a = 0; a < 3; ++a) {
        is_clamped[a] = (beyond >> a & 1) != 0;
        exists = exists && (!is_clamped[a] || t[a] == 0 || t[a] == 1);
      }
      if (!exists) continue;
      Jacobian F;
      displacement_at(t, is_clamped, &F);
      least = std::min(least, F.det());
    }
    return least;
  }

  void refuse_folds() const {
    std::array<int, 3> checks;
    for (int a = 0; a < 3; ++a) checks[a] = kChecksPerPoint * (m_points[a] - 1);
    double least = HUGE_VAL;
    for (int i = 0; i <= checks[0]; ++i) {
      for (int j = 0; j <= checks[1]; ++j) {
        for (int k = 0; k <= checks[2]; ++k) {
          const Vec3d t(double(i) / checks[0], double(j) / checks[1], double(k) / checks[2]);
          least = std::min(least, least_det(t));
        }
      }
    }
    require_path(least > 0, "move", "a lattice that folds, det F " + number_text(least),
                 "shorter displacements, which keep det F above 0");
  }

  Geometry m_geometry;
  std::array<int, 3> m_points;
  std::vector<LatticeParams::Move> m_moves;
  Vec3d m_lo, m_size;
  std::array<Vec3d, 3> m_gradient;  // of the box's coordinates, per mm
};

}  // namespace

std::shared_ptr<const PathFunction> make_lattice(const LatticeParams& params,
                                                 const Geometry& geometry) {
  require_finite("box", params.corner_index);
  require_finite("box", params.opposite_index);
  for (int a = 0; a < 3; ++a) {
    require_between("lattice", params.points[a], 2, kMaxPoints, "control points along an axis");
    require_path(params.corner_index[a] != params.opposite_index[a], "box", "a box without volume",
                 "two corners that differ along every axis");
  }
  LatticeParams moving = params;
  moving.moves.clear();
  for (const LatticeParams::Move& move : params.moves) {
    for (int a = 0; a < 3; ++a) {
      if (move.point[a] >= 0 && move.point[a] < params.points[a]) continue;
      throw InputError({move.place, "move",
                        "control point " + std::to_string(move.point[0]) + "," +
                            std::to_string(move.point[1]) + "," + std::to_string(move.point[2]),
                        "one from 0,0,0 to " + std::to_string(params.points[0] - 1) + "," +
                            std::to_string(params.points[1] - 1) + "," +
                            std::to_string(params.points[2] - 1)});
    }
    require_finite("move", move.by_mm);
    if (move.by_mm != Vec3d(0)) moving.moves.push_back(move);
  }
  if (moving.moves.empty()) return nullptr;
  return std::make_shared<FreeFormLattice>(moving, geometry);
}

}  // namespace supple
