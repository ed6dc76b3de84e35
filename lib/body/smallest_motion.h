// The smallest rigid motion of a piece that takes its elements within bounds, such as those that
// handles and anchors set through tissue: of a motion x -> T (x - c) + c + t, c the centre of the
// elements, the one with the least sum of squared ways, sum |T r - r|^2 + N |t|^2. The cost of a
// turn includes the tissue that it carries: each element counts as a cube. Without that a small
// piece that is carried far would pivot by any angle, to save a part of its own size.
//
// Bounds are linear in the offset of an element, and offsets nearly linear in the six unknowns of a
// further small motion. So each iteration solves a convex quadratic program, 6 unknowns and two
// bounds for each element and coordinate, exactly (active sets of Goldfarb and Idnani, Math.
// Program. 27, 1-33, 1983), about the motion of the one before; turns of 20 degrees take 5 to 8.
// Cost: about 20 ns per bounded element and constraint looked at, some dozens per iteration.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "lib/body/body.h"
#include "volumes/base/progress.h"

namespace supple {

// The point nearest to the origin within half-spaces of six dimensions: a strictly convex quadratic
// program in the coordinates in which its Hessian is the identity.
//
// Half-spaces are added one by one; the caller chooses the one that is violated most. The dual
// method of Goldfarb and Idnani (Math. Program. 27, 1-33, 1983) keeps the set of those that are met
// with equality. After each addition the point is the nearest one in all half-spaces added so far,
// exact to rounding. O(active^2) per change of the set, at most six active.

using Vec6 = std::array<double, 6>;

double dot(const Vec6& a, const Vec6& b);

class NearestPoint {
 public:
  const Vec6& x() const { return m_x; }
  /// Moves to the nearest point with row . x >= least too, which x does not meet. False where no
  /// point meets all.
  bool add(const Vec6& row, double least);

 private:
  struct Active {
    Vec6 row;
    double multiplier;
  };

  Vec6 combined_from(const Vec6& row, std::vector<double>& parts) const;

  Vec6 m_x{};
  std::vector<Active> m_active;
};

/// Lower triangle L of a symmetric matrix L L^T; false where that is not positive.
bool factorize(std::array<Vec6, 6>& matrix);
/// Solves L x = b for x.
Vec6 solve_lower(const std::array<Vec6, 6>& lower, Vec6 b);
/// Solves L^T x = b for x.
Vec6 solve_upper(const std::array<Vec6, 6>& lower, Vec6 b);

/// Bounds of the offsets of one element of a piece.
struct ElementBounds {
  static constexpr std::int32_t kNone = INT32_MAX;  // of `most`; -kNone of `least`
  Slot slot;
  std::array<std::int32_t, 3> least, most;  // q, per coordinate
};

/// The pose that the smallest motion takes the piece to from where its motion starts; bounds, of
/// elements of the piece, hold for rounded offsets there. `cube_mm`: edge of each element as a
/// cube, at least its voxel. Nothing where no motion meets the bounds. Throws Cancelled.
std::optional<RigidPose> smallest_pose(const Body& body, const RigidPiece& piece,
                                       const std::vector<ElementBounds>& bounds, double cube_mm = 0,
                                       const Progress* progress = nullptr);

}  // namespace supple
