#include "lib/fem/dynamics/rigid_motions.h"

#include <Eigen/LU>

#include "lib/fem/node_vectors.h"

namespace supple {

RigidMotions::RigidMotions(const ElasticSolid& solid, const MassMatrix& mass)
    : m_mass(mass),
      m_positions(solid.node_positions()),
      m_turn_axes(solid.turn_axes()),
      m_first_turn(m_positions.size() - m_turn_axes.size()) {
  NodePieces pieces = solid.node_pieces();
  m_piece_of = std::move(pieces.of_node);
  m_pieces.resize(std::size_t(pieces.count));
  std::vector<double> nodes(m_pieces.size());
  for (std::size_t n = 0; n < m_positions.size(); ++n) {
    m_pieces[std::size_t(m_piece_of[n])].centre_mm += m_positions[n];
    ++nodes[std::size_t(m_piece_of[n])];
  }
  for (std::size_t p = 0; p < m_pieces.size(); ++p) m_pieces[p].centre_mm /= nodes[p];
  // Motion k of all pieces at once, its forces of inertia, and their products with all motions.
  std::vector<double> motion(3 * m_positions.size());
  for (int k = 0; k < 6; ++k) {
    const Coefficients unit = Coefficients::Unit(k);
    for (std::size_t n = 0; n < m_positions.size(); ++n) {
      const Vec3d at = motion_at(n, unit);
      for (int a = 0; a < 3; ++a) motion[3 * n + std::size_t(a)] = at[a];
    }
    const std::vector<Coefficients> products = products_with(mass.times(motion).data());
    for (std::size_t p = 0; p < m_pieces.size(); ++p) {
      m_pieces[p].inverse_gram.col(k) = products[p];
    }
  }
  for (Piece& piece : m_pieces) piece.inverse_gram = piece.inverse_gram.inverse().eval();
}

std::size_t RigidMotions::bytes() const {
  return m_positions.capacity() * sizeof(Vec3d) + m_piece_of.capacity() * sizeof(std::int32_t) +
         m_pieces.capacity() * sizeof(Piece);
}

/// Three translations, and turns about the piece's centre.
Vec3d RigidMotions::motion_at(std::size_t node, const Coefficients& of) const {
  if (node >= m_first_turn) {
    const auto& [a, b, c] = m_turn_axes[node - m_first_turn];
    const Vec3d turn(of[3], of[4], of[5]);
    return {turn.dot(a), turn.dot(b), turn.dot(c)};
  }
  const Vec3d arm = m_positions[node] - m_pieces[std::size_t(m_piece_of[node])].centre_mm;
  return Vec3d(of[0], of[1], of[2]) + Vec3d(of[3], of[4], of[5]).cross(arm);
}

/// Returns products of every piece's motions with a vector of forces, summed node by node.
std::vector<RigidMotions::Coefficients> RigidMotions::products_with(const double* force) const {
  std::vector<Coefficients> sums(m_pieces.size(), Coefficients::Zero());
  for (std::size_t n = 0; n < m_positions.size(); ++n) {
    const std::size_t p = std::size_t(m_piece_of[n]);
    const Vec3d f(force[3 * n], force[3 * n + 1], force[3 * n + 2]);
    const bool is_turn = n >= m_first_turn;
    Vec3d moment = (m_positions[n] - m_pieces[p].centre_mm).cross(f);
    if (is_turn) {
      const auto& [a, b, c] = m_turn_axes[n - m_first_turn];
      moment = a * f.x + b * f.y + c * f.z;
    }
    for (int a = 0; a < 3; ++a) {
      sums[p][a] += is_turn ? 0 : f[a];
      sums[p][3 + a] += moment[a];
    }
  }
  return sums;
}

void RigidMotions::remove_from(double* x, std::vector<double>& scratch) const {
  scratch.assign(3 * m_positions.size(), 0.0);
  m_mass.add(x, scratch.data());
  std::vector<Coefficients> parts = products_with(scratch.data());
  for (std::size_t p = 0; p < m_pieces.size(); ++p) {
    parts[p] = (m_pieces[p].inverse_gram * parts[p]).eval();
  }
  static_assert(kVectorRange % 3 == 0, "ranges hold whole nodes");
  for_ranges(3 * m_positions.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin / 3; n < end / 3; ++n) {
      const Vec3d at = motion_at(n, parts[std::size_t(m_piece_of[n])]);
      for (int a = 0; a < 3; ++a) x[3 * n + std::size_t(a)] -= at[a];
    }
  });
}

}  // namespace supple
