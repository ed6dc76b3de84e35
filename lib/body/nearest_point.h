// The point nearest to the origin within half-spaces of six dimensions: a strictly convex quadratic
// program in the coordinates in which its Hessian is the identity.
//
// Half-spaces are added one by one; the caller chooses the one that is violated most. The dual
// method of Goldfarb and Idnani (Math. Program. 27, 1-33, 1983) keeps the set of those that are met
// with equality. After each addition the point is the nearest one in all half-spaces added so far,
// exact to rounding. O(active^2) per change of the set, at most six active.
#pragma once

#include <array>
#include <vector>

namespace supple {

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

}  // namespace supple
