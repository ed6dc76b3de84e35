// One lattice cell under a trilinear displacement, and its inverse (design.md section 4).
//
// With eta in [-1/2, 1/2]^3 the cell maps to
//   P(eta) = m + G eta + Bxy ex ey + Byz ey ez + Bxz ex ez + Bxyz ex ey ez.
// Multiplied by the inverse of G this is eta + N(eta) = t, N small for cells that are nearly
// parallelepipeds. Newton solves it; bounds on N prove most other nodes outside without a solve,
// and where neither Newton nor the bounds decide, bisection can: the image of a box lies in the
// hull of its eight corners. Valid for any corners, folded and collapsed cells included.
// Cost: about 60 ns to set up and 25 ns per node (one core).
#pragma once

#include "volumes/field/inversion/cell_corners.h"

namespace supple {

class DeformedCell {
 public:
  enum class Outcome { inside, outside, undecided };

  DeformedCell(const CellCorners& corners, bool folded);

  /// Looks for local coordinates in [0, 1]^3 that map to `x` (relative to the lowest corner, like
  /// the corners) to within `tolerance` voxels. `undecided` where Newton found nothing inside and
  /// no bound proves that there is nothing; always so in folded and collapsed cells.
  Outcome solve(const Vec3d& x, double tolerance, int max_steps, Vec3d& local) const;

  /// The same by bisection: finds every solution, of which the one with the smallest |local - x|
  /// is returned. `undecided` only where neither a solution nor its absence could be shown.
  Outcome solve_by_bisection(const Vec3d& x, double tolerance, int max_steps, Vec3d& local) const;

 private:
  struct Target;
  struct Search;
  Target target_of(const Vec3d& x, double tolerance, int max_steps) const;
  Vec3d value(const Vec3d& eta) const;
  void jacobian(const Vec3d& eta, Vec3d& jx, Vec3d& jy, Vec3d& jz) const;
  bool is_injective(const Vec3d& middle, const Vec3d& half) const;
  bool newton(const Target& target, Vec3d& eta) const;
  void bisect(Search& search, const Vec3d& lo, const Vec3d& hi, int depth) const;

  Vec3d m_center;           // P(0)
  Vec3d m_inverse_rows[3];  // of G; of the unit matrix where G is singular
  Vec3d m_xy, m_yz, m_xz, m_xyz;
  Vec3d m_lo, m_hi;    // box of the preconditioned corners
  Vec3d m_rest[3];     // columns of G - 1 where G is singular
  double m_scale = 1;  // voxels per unit of the preconditioned equation
  double m_bend = 0;   // |N(a + b) - N(a) - N'(a) b| <= m_bend |b|^2 for |a| <= 2, |b| <= 1
  bool m_singular = false;
  bool m_folded = false;
  bool m_injective = false;  // on a box larger than the cell
};

}  // namespace supple
