#include "lib/fem/voxel/hinges.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/SparseCholesky>

#include "lib/fem/voxel/corner_sets.h"
#include "lib/fem/voxel/voxel_nodes.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

using TurnMatrix = Eigen::Matrix<double, 6, 6>;
using Matrix36 = Eigen::Matrix<double, 3, 6>;

/// Shift of the scaled matrix, and the part of a random vector that tells a motion.
constexpr double kShift = 1e-10, kMoved = 1e-3;

/// A node and one of the pieces around it.
struct NodeOfPiece {
  NodeIndex node;
  std::int32_t piece;

  bool operator==(const NodeOfPiece& other) const {
    return node == other.node && piece == other.piece;
  }
  bool operator<(const NodeOfPiece& other) const {
    return node != other.node ? node < other.node : piece < other.piece;
  }
};

/// Pieces of elements that are joined over faces, numbered by their first element.
struct FacePieces {
  std::vector<std::int32_t> of_element, first_of_node;
  std::vector<NodeOfPiece> further;  // ascending: all but the first piece of a node
  std::vector<std::int64_t> elements;

  explicit FacePieces(const HexMesh& mesh)
      : of_element(mesh.offset.size()), first_of_node(std::size_t(mesh.node_count()), -1) {
    CornerSets sets(mesh.offset.size());
    const BrickIndex index(mesh.origin);
    for_each(mesh, [&](std::size_t block, std::int32_t e) {
      for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t beside = element_across(mesh, index, block, e, axis, true);
        if (beside >= 0) sets.join(std::uint32_t(e), std::uint32_t(beside));
      }
    });
    for (std::uint32_t e = 0; e < of_element.size(); ++e) {
      const std::uint32_t first = sets.find(e);
      if (first == e) elements.push_back(0);
      of_element[e] = first == e ? std::int32_t(elements.size()) - 1 : of_element[first];
      ++elements[std::size_t(of_element[e])];
    }
    for_each(mesh, [&](std::size_t block, std::int32_t e) {
      const std::int32_t piece = of_element[std::size_t(e)];
      for (const NodeIndex node : mesh.corners_in(block, e)) {
        std::int32_t& first = first_of_node[std::size_t(node)];
        if (first < 0) first = piece;
        if (first != piece) further.push_back({node, piece});
      }
    });
    std::sort(further.begin(), further.end());
    further.erase(std::unique(further.begin(), further.end()), further.end());
  }

 private:
  template <class Visit>
  static void for_each(const HexMesh& mesh, Visit&& visit) {
    for (std::size_t block = 0; block < mesh.block_count(); ++block) {
      for (auto e = mesh.element_begin[block]; e < mesh.element_begin[block + 1]; ++e) {
        visit(block, e);
      }
    }
  }
};

/// The conditions on the rigid motions of pieces that share nodes.
class PieceMotions {
 public:
  PieceMotions(const HexMesh& mesh, const FacePieces& pieces, const HeldBits& held)
      : m_positions(node_positions(mesh)), m_pieces(pieces) {
    number_pieces();
    const bool is_free = std::all_of(held.begin(), held.end(), [](auto bits) { return bits == 0; });
    m_own.assign(m_centre.size(), TurnMatrix::Zero());
    for (const NodeOfPiece& at : pieces.further) {
      tie(at.node, m_number[std::size_t(first_of(at.node))], m_number[std::size_t(at.piece)]);
    }
    if (is_free) {
      hold_largest();
      return;
    }
    for (std::size_t n = 0; n < held.size(); ++n) {
      const std::int32_t number = m_number[std::size_t(first_of(NodeIndex(n)))];
      if (held[n] != 0 && number >= 0) hold(NodeIndex(n), held[n], number);
    }
  }

  /// Tells for each piece of the body whether it can move without strain.
  std::vector<bool> moving() const;

 private:
  std::int32_t first_of(NodeIndex node) const { return m_pieces.first_of_node[std::size_t(node)]; }

  void number_pieces() {
    m_number.assign(m_pieces.elements.size(), -1);
    const auto take = [&](std::int32_t piece, NodeIndex node) {
      std::int32_t& number = m_number[std::size_t(piece)];
      if (number >= 0) return;
      number = std::int32_t(m_centre.size());
      m_centre.push_back(m_positions[std::size_t(node)]);
      m_piece.push_back(piece);
    };
    for (const NodeOfPiece& at : m_pieces.further) {
      take(first_of(at.node), at.node);
      take(at.piece, at.node);
    }
  }

  /// Displacement of a node by the motions of a piece: three translations, three turns.
  Matrix36 motion_at(NodeIndex node, std::int32_t number) const {
    const Vec3d arm = m_positions[std::size_t(node)] - m_centre[std::size_t(number)];
    Matrix36 motion;
    motion << 1, 0, 0, 0, arm.z, -arm.y,  //
        0, 1, 0, -arm.z, 0, arm.x,        //
        0, 0, 1, arm.y, -arm.x, 0;
    return motion;
  }

  void tie(NodeIndex node, std::int32_t a, std::int32_t b) {
    const Matrix36 of_a = motion_at(node, a), of_b = motion_at(node, b);
    m_own[std::size_t(a)] += of_a.transpose() * of_a;
    m_own[std::size_t(b)] += of_b.transpose() * of_b;
    const TurnMatrix between = -of_a.transpose() * of_b;
    for (int n = 0; n < 6; ++n) {
      for (int m = 0; m < 6; ++m) m_entries.emplace_back(6 * a + n, 6 * b + m, between(n, m));
    }
    m_joins.push_back({a, b});
  }

  void hold(NodeIndex node, std::uint8_t bits, std::int32_t number) {
    const Matrix36 motion = motion_at(node, number);
    for (int a = 0; a < 3; ++a) {
      if ((bits >> a & 1) == 0) continue;
      m_own[std::size_t(number)] += motion.row(a).transpose() * motion.row(a);
    }
  }

  void hold_largest() {
    CornerSets sets(m_centre.size());
    for (const auto& [a, b] : m_joins) sets.join(std::uint32_t(a), std::uint32_t(b));
    std::vector<std::int32_t> largest(m_centre.size(), -1);
    const auto elements = [&](std::int32_t number) {
      return m_pieces.elements[std::size_t(m_piece[std::size_t(number)])];
    };
    for (std::uint32_t n = 0; n < m_centre.size(); ++n) {
      std::int32_t& best = largest[sets.find(n)];
      if (best < 0 || elements(std::int32_t(n)) > elements(best)) best = std::int32_t(n);
    }
    for (const std::int32_t best : largest) {
      if (best >= 0) m_own[std::size_t(best)] += TurnMatrix::Identity();
    }
  }

  std::vector<Vec3d> m_positions;
  const FacePieces& m_pieces;
  std::vector<std::int32_t> m_number;  // per piece of the body: its number here, or -1
  std::vector<std::int32_t> m_piece;   // and back
  std::vector<Vec3d> m_centre;         // about which it turns
  std::vector<TurnMatrix> m_own;
  std::vector<Eigen::Triplet<double>> m_entries;  // between pieces
  std::vector<std::array<std::int32_t, 2>> m_joins;
};

std::vector<bool> PieceMotions::moving() const {
  const int size = 6 * int(m_own.size());
  Eigen::VectorXd scale(size);
  for (int n = 0; n < size; ++n) {
    const double own = m_own[std::size_t(n / 6)](n % 6, n % 6);
    scale[n] = own > 0 ? 1 / std::sqrt(own) : 1;
  }
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int row, int column, double value) {
    if (row < column) std::swap(row, column);
    entries.emplace_back(row, column, value * scale[row] * scale[column]);
  };
  for (const Eigen::Triplet<double>& entry : m_entries) {
    add(entry.row(), entry.col(), entry.value());
  }
  for (int n = 0; n < size; ++n) {
    for (int m = 0; m <= n % 6; ++m) {
      add(n, n - n % 6 + m, m_own[std::size_t(n / 6)](n % 6, m));
    }
    entries.emplace_back(n, n, kShift);
  }
  Eigen::SparseMatrix<double> lower(size, size);
  lower.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(lower);
  if (factor.info() != Eigen::Success) throw Error("finite elements: hinges cannot be told");
  std::minstd_rand random(1);
  Eigen::VectorXd any(size);
  for (int n = 0; n < size; ++n) any[n] = double(random()) / double(random.max()) - 0.5;
  const Eigen::VectorXd left = kShift * factor.solve(any);
  std::vector<bool> moves(m_number.size());
  for (int n = 0; n < size; ++n) {
    if (std::abs(left[n]) > kMoved) moves[std::size_t(m_piece[std::size_t(n / 6)])] = true;
  }
  return moves;
}

}  // namespace

std::vector<bool> hinged_elements(const HexMesh& voxels, const HeldBits& held) {
  const FacePieces pieces(voxels);
  if (pieces.further.empty()) return {};
  const std::vector<bool> moves = PieceMotions(voxels, pieces, held).moving();
  if (std::find(moves.begin(), moves.end(), true) == moves.end()) return {};
  std::vector<bool> hinged(pieces.of_element.size());
  for (std::size_t e = 0; e < hinged.size(); ++e) {
    hinged[e] = moves[std::size_t(pieces.of_element[e])];
  }
  return hinged;
}

}  // namespace supple
