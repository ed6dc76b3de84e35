// Poses of rigid pieces from sums over their elements that are linear in the displacements of
// these: those of a sum of responses are the sum of theirs, and no element is visited to fit a
// pose.
#pragma once

#include <vector>

#include "lib/body/body.h"
#include "lib/fem/small_matrix.h"

namespace supple {

/// Sums over the elements of a piece, whose places at rest count from its middle.
struct PieceMoments {
  Vec3d shift{0, 0, 0};  // of displacements
  Matrix9 product{};     // of places (rows) and displacements

  void add(const PieceMoments& other, double part);
};

/// The pieces of a body at rest.
class PieceFits {
 public:
  /// Visits all elements of pieces. The body must outlive this, its pieces stay.
  explicit PieceFits(const Body& body);

  /// The moments of all pieces; displacements in mm, LPS, in the order of the bricks.
  std::vector<PieceMoments> moments(const std::vector<Vec3d>& u_mm) const;
  /// The poses of all pieces that are nearest to where their elements go.
  std::vector<RigidPose> poses(const std::vector<PieceMoments>& moments) const;

 private:
  struct AtRest {
    RigidPiece piece;
    Matrix9 products{};  // of places by themselves
    double squares = 0;
  };
  const Body& m_body;
  std::vector<AtRest> m_pieces;
};

}  // namespace supple
