// The rigid motions of pieces that nothing holds, which K does not see: each piece has six. A
// vector without them is M-orthogonal to all.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "lib/fem/dynamics/mass.h"

namespace supple {

class RigidMotions {
 public:
  /// Finds the motions of all pieces of the body. `mass` must outlive this.
  RigidMotions(const ElasticSolid& solid, const MassMatrix& mass);

  /// Takes the rigid motions out of x; `scratch` is used up.
  void remove_from(double* x, std::vector<double>& scratch) const;

  std::int64_t count() const { return 6 * std::int64_t(m_pieces.size()); }
  std::size_t bytes() const;

 private:
  using Coefficients = Eigen::Matrix<double, 6, 1>;
  struct Piece {
    Vec3d centre_mm{0, 0, 0};
    Eigen::Matrix<double, 6, 6> inverse_gram;  // of the motions in the inner product of M
  };
  std::vector<Coefficients> products_with(const double* force) const;
  Vec3d motion_at(std::size_t node, const Coefficients& of) const;

  const MassMatrix& m_mass;
  std::vector<Vec3d> m_positions;
  std::vector<std::array<Vec3d, 3>> m_turn_axes;  // of the last nodes
  std::size_t m_first_turn = 0;
  std::vector<std::int32_t> m_piece_of;  // per node
  std::vector<Piece> m_pieces;
};

}  // namespace supple
