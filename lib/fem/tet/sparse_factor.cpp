#include "lib/fem/tet/sparse_factor.h"

#include <algorithm>
#include <numeric>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "volumes/base/error.h"

namespace supple {

namespace {

/// So few nodes are not divided any more.
constexpr std::size_t kSmallPart = 24;

class Dissection {
 public:
  Dissection(const BlockCsr& matrix, const std::vector<Vec3d>& positions)
      : m_matrix(matrix), m_positions(positions), m_side(positions.size()) {}

  void add(std::vector<NodeIndex> nodes, std::vector<NodeIndex>& order) {
    if (nodes.size() <= kSmallPart) {
      order.insert(order.end(), nodes.begin(), nodes.end());
      return;
    }
    const auto middle = nodes.begin() + std::int64_t(nodes.size() / 2);
    const int axis = longest_axis(nodes);
    std::nth_element(nodes.begin(), middle, nodes.end(), [&](NodeIndex a, NodeIndex b) {
      const double x = m_positions[std::size_t(a)][axis], y = m_positions[std::size_t(b)][axis];
      return x != y ? x < y : a < b;
    });
    const int here = ++m_parts, there = ++m_parts;
    for (auto it = nodes.begin(); it != nodes.end(); ++it) {
      m_side[std::size_t(*it)] = it < middle ? here : there;
    }
    const auto borders = [&](NodeIndex node) {
      const auto first = m_matrix.columns().begin() + m_matrix.begin()[std::size_t(node)];
      const auto last = m_matrix.columns().begin() + m_matrix.begin()[std::size_t(node) + 1];
      return std::any_of(first, last,
                         [&](NodeIndex other) { return m_side[std::size_t(other)] == there; });
    };
    std::vector<NodeIndex> left(nodes.begin(), middle), right(middle, nodes.end());
    std::sort(left.begin(), left.end());
    std::sort(right.begin(), right.end());
    const auto cut = std::stable_partition(left.begin(), left.end(),
                                           [&](NodeIndex node) { return !borders(node); });
    const std::vector<NodeIndex> between(cut, left.end());
    left.erase(cut, left.end());
    add(std::move(left), order);
    add(std::move(right), order);
    order.insert(order.end(), between.begin(), between.end());
  }

 private:
  int longest_axis(const std::vector<NodeIndex>& nodes) const {
    Vec3d lo = m_positions[std::size_t(nodes[0])], hi = lo;
    for (const NodeIndex node : nodes) {
      for (int a = 0; a < 3; ++a) {
        lo[a] = std::min(lo[a], m_positions[std::size_t(node)][a]);
        hi[a] = std::max(hi[a], m_positions[std::size_t(node)][a]);
      }
    }
    const Vec3d extent = hi - lo;
    if (extent.x >= extent.y && extent.x >= extent.z) return 0;
    return extent.y >= extent.z ? 1 : 2;
  }

  const BlockCsr& m_matrix;
  const std::vector<Vec3d>& m_positions;
  std::vector<int> m_side;
  int m_parts = 0;
};

}  // namespace

std::vector<NodeIndex> nested_dissection(const BlockCsr& matrix,
                                         const std::vector<Vec3d>& positions) {
  std::vector<NodeIndex> all(matrix.node_count()), order;
  std::iota(all.begin(), all.end(), 0);
  order.reserve(all.size());
  Dissection(matrix, positions).add(std::move(all), order);
  return order;
}

struct SparseFactor::Parts {
  using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
  std::vector<int> unknown_of;  // per component of a node; -1 where it is held
  int count = 0;
  Eigen::SimplicialLLT<Matrix, Eigen::Lower, Eigen::NaturalOrdering<int>> factor;
};

SparseFactor::SparseFactor(const BlockCsr& matrix, const HeldBits& held,
                           const std::vector<Vec3d>& positions)
    : m_parts(std::make_unique<Parts>()) {
  Parts& parts = *m_parts;
  parts.unknown_of.assign(3 * matrix.node_count(), -1);
  for (const NodeIndex node : nested_dissection(matrix, positions)) {
    for (std::size_t a = 0; a < 3; ++a) {
      if ((held[std::size_t(node)] >> a & 1) != 0) continue;
      parts.unknown_of[3 * std::size_t(node) + a] = parts.count++;
    }
  }
  std::vector<Eigen::Triplet<double, int>> entries;
  entries.reserve(matrix.columns().size() * 5);
  for (std::size_t at = 0; at < parts.unknown_of.size(); ++at) {
    const int row = parts.unknown_of[at];
    if (row < 0) continue;
    for (std::int64_t n = matrix.begin()[at / 3]; n < matrix.begin()[at / 3 + 1]; ++n) {
      const Matrix9& block = matrix.blocks()[std::size_t(n)];
      for (std::size_t b = 0; b < 3; ++b) {
        const std::size_t other = 3 * std::size_t(matrix.columns()[std::size_t(n)]) + b;
        const int column = parts.unknown_of[other];
        if (column >= 0 && column <= row) entries.emplace_back(row, column, block[at % 3 * 3 + b]);
      }
    }
  }
  Parts::Matrix lower(parts.count, parts.count);
  lower.setFromTriplets(entries.begin(), entries.end());
  parts.factor.compute(lower);
  if (parts.factor.info() != Eigen::Success) {
    throw Error("finite elements: a stiffness matrix that is not positive definite");
  }
}

SparseFactor::~SparseFactor() = default;

void SparseFactor::solve(const double* r, double* z) const {
  const Parts& parts = *m_parts;
  Eigen::VectorXd x(parts.count);
  for (std::size_t n = 0; n < parts.unknown_of.size(); ++n) {
    if (parts.unknown_of[n] >= 0) x[parts.unknown_of[n]] = r[n];
  }
  x = parts.factor.solve(x).eval();
  for (std::size_t n = 0; n < parts.unknown_of.size(); ++n) {
    z[n] = parts.unknown_of[n] >= 0 ? x[parts.unknown_of[n]] : 0;
  }
}

std::size_t SparseFactor::entry_count() const {
  return m_parts->count == 0 ? 0
                             : std::size_t(m_parts->factor.matrixL().nestedExpression().nonZeros());
}
std::size_t SparseFactor::bytes() const {
  return entry_count() * (sizeof(double) + sizeof(int)) + m_parts->unknown_of.size() * sizeof(int);
}

}  // namespace supple
