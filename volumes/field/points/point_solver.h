// X with X + u(X) = x, for a displacement that is trilinear in lattice cells.
//
// Newton with steps that are halved until they help; Newton can come to a standstill at the kinks
// between cells, so that the cells around the last place are searched one by one then.
#pragma once

#include <algorithm>
#include <cmath>

#include "volumes/field/inversion/deformed_cell.h"
#include "volumes/field/inversion/trilinear_cell.h"

namespace supple {

/// Voxels, of the place that a solution reaches; the solution itself is as near where tissue is not
/// compressed to less than a tenth.
constexpr double kPointTolerance = 1e-6;

/// `Cells` has `cell(voxel, cell)`, which gives the corners of a cell, and `cell_at(X, voxel,
/// cell)`, which finds the one around a place and may snap the place to it; both are false where
/// there is none.
template <class Cells>
class PointSolver {
 public:
  explicit PointSolver(const Cells& cells) : m_cells(cells) {}

  /// Solves for x from `start`; false when nothing was found.
  bool solve(const Vec3d& x, const Vec3d& start, Vec3d& found) const {
    found = start;
    CellPlace place;
    if (!place_at(found, place)) return false;
    Vec3d residual = found + place.u - x;
    for (int step = 0; step < kMaxSteps; ++step) {
      if (residual.length() <= kPointTolerance) return true;
      Columns inverse;
      if (!invert(place.gradient(), inverse)) break;
      if (!advance(x, product(inverse, residual), found, place, residual)) break;
    }
    return residual.length() <= kPointTolerance || search_around(x, found);
  }

 private:
  static constexpr int kMaxSteps = 30;
  static constexpr int kMaxHalvings = 6;
  static constexpr double kMaxStep = 8;  // voxels
  static constexpr int kAround = 2;      // cells

  static Vec3i floor_voxel(const Vec3d& p) {
    return {int(std::floor(p.x)), int(std::floor(p.y)), int(std::floor(p.z))};
  }

  bool place_at(Vec3d& X, CellPlace& place) const {
    for (int a = 0; a < 3; ++a) {
      if (!(std::abs(X[a]) < 1e8)) return false;
    }
    Vec3i voxel;
    TrilinearCell cell;
    if (!m_cells.cell_at(X, voxel, cell)) return false;
    place = cell.at(X - Vec3d(voxel));
    return true;
  }

  /// Makes one step that makes the residual smaller; false where none of the halved ones does.
  bool advance(const Vec3d& x, Vec3d step, Vec3d& X, CellPlace& place, Vec3d& residual) const {
    const double length = step.length();
    if (!(length < 1e8)) return false;
    if (length > kMaxStep) step *= kMaxStep / length;
    for (int n = 0; n <= kMaxHalvings; ++n, step *= 0.5) {
      CellPlace next;
      Vec3d to = X - step;
      if (!place_at(to, next)) continue;
      const Vec3d left = to + next.u - x;
      if (!(left.length() < residual.length())) continue;
      X = to;
      place = next;
      residual = left;
      return true;
    }
    return false;
  }

  /// Finds, of the solutions in the cells around, the one with the shortest way.
  bool search_around(const Vec3d& x, Vec3d& found) const {
    const Vec3i centre = floor_voxel(found);
    double shortest = HUGE_VAL;
    for (int i = -kAround; i <= kAround; ++i) {
      for (int j = -kAround; j <= kAround; ++j) {
        for (int k = -kAround; k <= kAround; ++k) {
          const Vec3i voxel = centre + Vec3i(i, j, k);
          TrilinearCell cell;
          Vec3d local;
          if (!m_cells.cell(voxel, cell) || !solve_in(cell, x - Vec3d(voxel), local)) continue;
          const Vec3d X = Vec3d(voxel) + local;
          if ((X - x).length2() >= shortest) continue;
          shortest = (X - x).length2();
          found = X;
        }
      }
    }
    return shortest < HUGE_VAL;
  }

  static bool solve_in(const TrilinearCell& cell, const Vec3d& x, Vec3d& local) {
    const CellCorners corners = cell.corners();
    for (int a = 0; a < 3; ++a) {
      const auto [lo, hi] = std::minmax_element(corners.p[a], corners.p[a] + 8);
      if (!(x[a] >= *lo - kPointTolerance && x[a] <= *hi + kPointTolerance)) return false;
    }
    const bool is_folded = cell.is_folded();
    const DeformedCell deformed(corners, is_folded);
    auto outcome = deformed.solve(x, kPointTolerance, kMaxSteps, local);
    if (outcome == DeformedCell::Outcome::outside) return false;
    if (is_folded || outcome == DeformedCell::Outcome::undecided) {
      outcome = deformed.solve_by_bisection(x, kPointTolerance, kMaxSteps, local);
    }
    return outcome == DeformedCell::Outcome::inside;
  }

  const Cells& m_cells;
};

}  // namespace supple
