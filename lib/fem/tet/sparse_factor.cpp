#include "lib/fem/tet/sparse_factor.h"

#include <algorithm>
#include <atomic>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "volumes/base/error.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// The largest number of nodes that are not divided any more.
constexpr std::size_t kSmallPart = 40;
/// Halves of so many unknowns are worth a thread of their own.
constexpr std::int32_t kLargePart = 300;

using Unknowns = std::vector<std::int32_t>;

/// A part of the tree. Unknowns are numbered in the order of elimination.
struct Front {
  std::int32_t first = 0, end = 0;  // its own unknowns
  std::int32_t subtree_first = 0;   // with those of its halves
  int left = -1, right = -1;
  Unknowns outer;         // later ones that it is coupled with, ascending
  Eigen::MatrixXd lower;  // columns of L, of its own and the outer unknowns
  Eigen::MatrixXd left_over;

  std::int32_t own() const { return end - first; }
};

int longest_axis(const std::vector<NodeIndex>& nodes, const std::vector<Vec3d>& positions) {
  Vec3d lo = positions[std::size_t(nodes[0])], hi = lo;
  for (const NodeIndex node : nodes) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], positions[std::size_t(node)][a]);
      hi[a] = std::max(hi[a], positions[std::size_t(node)][a]);
    }
  }
  const Vec3d extent = hi - lo;
  if (extent.x >= extent.y && extent.x >= extent.z) return 0;
  return extent.y >= extent.z ? 1 : 2;
}

}  // namespace

struct SparseFactor::Parts {
  const BlockCsr* matrix = nullptr;       // while factors are found
  std::vector<Front> fronts;              // halves before what they are halves of
  std::vector<std::int32_t> unknown_of;   // per component of a node; -1 where it is held
  std::vector<std::size_t> component_of;  // per unknown
  std::vector<int> side;                  // per node: the half that it is in
  int sides = 0;
  std::atomic<bool> is_definite{true};

  int dissect(std::vector<NodeIndex> nodes, const HeldBits& held,
              const std::vector<Vec3d>& positions);
  void number(const std::vector<NodeIndex>& nodes, const HeldBits& held, Front& front);
  void find_outer();
  void eliminate(int at);
  void add_entries(const Front& front, Eigen::MatrixXd& dense) const;
  static void take(const Front& front, Front& half, Eigen::MatrixXd& dense);
};

/// Adds the fronts of some nodes, and returns the last one.
int SparseFactor::Parts::dissect(std::vector<NodeIndex> nodes, const HeldBits& held,
                                 const std::vector<Vec3d>& positions) {
  Front front;
  front.subtree_first = std::int32_t(component_of.size());
  if (nodes.size() > kSmallPart) {
    const auto middle = nodes.begin() + std::int64_t(nodes.size() / 2);
    const int axis = longest_axis(nodes, positions);
    std::nth_element(nodes.begin(), middle, nodes.end(), [&](NodeIndex a, NodeIndex b) {
      const double x = positions[std::size_t(a)][axis], y = positions[std::size_t(b)][axis];
      return x != y ? x < y : a < b;
    });
    const int here = ++sides, there = ++sides;
    for (auto it = nodes.begin(); it != nodes.end(); ++it) {
      side[std::size_t(*it)] = it < middle ? here : there;
    }
    const auto borders = [&](NodeIndex node) {
      const auto first = matrix->columns().begin() + matrix->begin()[std::size_t(node)];
      const auto last = matrix->columns().begin() + matrix->begin()[std::size_t(node) + 1];
      return std::any_of(first, last,
                         [&](NodeIndex other) { return side[std::size_t(other)] == there; });
    };
    std::vector<NodeIndex> left(nodes.begin(), middle), right(middle, nodes.end());
    std::sort(left.begin(), left.end());
    std::sort(right.begin(), right.end());
    const auto cut = std::stable_partition(left.begin(), left.end(),
                                           [&](NodeIndex node) { return !borders(node); });
    nodes.assign(cut, left.end());
    left.erase(cut, left.end());
    if (!left.empty()) front.left = dissect(std::move(left), held, positions);
    front.right = dissect(std::move(right), held, positions);
  }
  number(nodes, held, front);
  fronts.push_back(std::move(front));
  return int(fronts.size()) - 1;
}

void SparseFactor::Parts::number(const std::vector<NodeIndex>& nodes, const HeldBits& held,
                                 Front& front) {
  front.first = std::int32_t(component_of.size());
  for (const NodeIndex node : nodes) {
    for (std::size_t a = 0; a < 3; ++a) {
      if ((held[std::size_t(node)] >> a & 1) != 0) continue;
      unknown_of[3 * std::size_t(node) + a] = std::int32_t(component_of.size());
      component_of.push_back(3 * std::size_t(node) + a);
    }
  }
  front.end = std::int32_t(component_of.size());
}

void SparseFactor::Parts::find_outer() {
  for (Front& front : fronts) {
    for (std::int32_t u = front.first; u < front.end; ++u) {
      const std::size_t node = component_of[std::size_t(u)] / 3;
      for (std::int64_t n = matrix->begin()[node]; n < matrix->begin()[node + 1]; ++n) {
        const std::size_t other = 3 * std::size_t(matrix->columns()[std::size_t(n)]);
        front.outer.insert(front.outer.end(), &unknown_of[other], &unknown_of[other] + 3);
      }
    }
    for (const int half : {front.left, front.right}) {
      if (half < 0) continue;
      const Unknowns& outer = fronts[std::size_t(half)].outer;
      front.outer.insert(front.outer.end(), outer.begin(), outer.end());
    }
    std::sort(front.outer.begin(), front.outer.end());
    front.outer.erase(std::unique(front.outer.begin(), front.outer.end()), front.outer.end());
    front.outer.erase(front.outer.begin(),
                      std::lower_bound(front.outer.begin(), front.outer.end(), front.end));
  }
}

void SparseFactor::Parts::add_entries(const Front& front, Eigen::MatrixXd& dense) const {
  const auto row_of = [&](std::int32_t unknown) {
    if (unknown < front.end) return Eigen::Index(unknown - front.first);
    const auto at = std::lower_bound(front.outer.begin(), front.outer.end(), unknown);
    return Eigen::Index(front.own() + (at - front.outer.begin()));
  };
  for (std::int32_t u = front.first; u < front.end; ++u) {
    const std::size_t component = component_of[std::size_t(u)], node = component / 3;
    for (std::int64_t n = matrix->begin()[node]; n < matrix->begin()[node + 1]; ++n) {
      const std::size_t other = 3 * std::size_t(matrix->columns()[std::size_t(n)]);
      for (std::size_t b = 0; b < 3; ++b) {
        const std::int32_t v = unknown_of[other + b];
        if (v < u) continue;
        dense(row_of(v), u - front.first) =
            matrix->blocks()[std::size_t(n)][3 * (component % 3) + b];
      }
    }
  }
}

/// Adds what a half has left over, and frees it.
void SparseFactor::Parts::take(const Front& front, Front& half, Eigen::MatrixXd& dense) {
  std::vector<Eigen::Index> row_of;
  std::size_t at = 0;
  for (const std::int32_t unknown : half.outer) {
    if (unknown < front.end) {
      row_of.push_back(unknown - front.first);
      continue;
    }
    while (front.outer[at] != unknown) ++at;
    row_of.push_back(front.own() + Eigen::Index(at));
  }
  for (std::size_t column = 0; column < row_of.size(); ++column) {
    for (std::size_t row = column; row < row_of.size(); ++row) {
      dense(row_of[row], row_of[column]) += half.left_over(Eigen::Index(row), Eigen::Index(column));
    }
  }
  half.left_over.resize(0, 0);
}

void SparseFactor::Parts::eliminate(int at) {
  Front& front = fronts[std::size_t(at)];
  TaskGroup group;
  const bool is_large = front.end - front.subtree_first > kLargePart;
  if (front.left >= 0 && is_large) group.run([this, &front] { eliminate(front.left); });
  if (front.left >= 0 && !is_large) eliminate(front.left);
  if (front.right >= 0) eliminate(front.right);
  group.wait();
  if (!is_definite) return;
  const Eigen::Index own = front.own(), outer = Eigen::Index(front.outer.size());
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(own + outer, own + outer);
  add_entries(front, dense);
  for (const int half : {front.left, front.right}) {
    if (half >= 0) take(front, fronts[std::size_t(half)], dense);
  }
  Eigen::Ref<Eigen::MatrixXd> own_block = dense.topLeftCorner(own, own);
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(own_block);
  if (factor.info() != Eigen::Success) {
    is_definite = false;
    return;
  }
  auto below = dense.bottomLeftCorner(outer, own);
  own_block.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(below);
  front.left_over = dense.bottomRightCorner(outer, outer);
  front.left_over.selfadjointView<Eigen::Lower>().rankUpdate(below, -1);
  front.lower = dense.leftCols(own);
}

SparseFactor::SparseFactor(const BlockCsr& matrix, const HeldBits& held,
                           const std::vector<Vec3d>& positions)
    : m_parts(std::make_unique<Parts>()) {
  m_parts->matrix = &matrix;
  m_parts->unknown_of.assign(3 * matrix.node_count(), -1);
  m_parts->side.assign(matrix.node_count(), 0);
  std::vector<NodeIndex> all(matrix.node_count());
  std::iota(all.begin(), all.end(), 0);
  const int last = m_parts->dissect(std::move(all), held, positions);
  m_parts->find_outer();
  m_parts->eliminate(last);
  if (!m_parts->is_definite) {
    throw Error("finite elements: a stiffness matrix that is not positive definite");
  }
}

SparseFactor::~SparseFactor() = default;

void SparseFactor::solve(const double* r, double* z) const {
  const Parts& parts = *m_parts;
  Eigen::VectorXd x(Eigen::Index(parts.component_of.size())), outer;
  for (std::size_t u = 0; u < parts.component_of.size(); ++u) {
    x[Eigen::Index(u)] = r[parts.component_of[u]];
  }
  for (const Front& front : parts.fronts) {
    auto own = x.segment(front.first, front.own());
    front.lower.topRows(front.own()).triangularView<Eigen::Lower>().solveInPlace(own);
    outer.noalias() = front.lower.bottomRows(Eigen::Index(front.outer.size())) * own;
    for (std::size_t n = 0; n < front.outer.size(); ++n)
      x[front.outer[n]] -= outer[Eigen::Index(n)];
  }
  for (auto front = parts.fronts.rbegin(); front != parts.fronts.rend(); ++front) {
    auto own = x.segment(front->first, front->own());
    outer.resize(Eigen::Index(front->outer.size()));
    for (std::size_t n = 0; n < front->outer.size(); ++n)
      outer[Eigen::Index(n)] = x[front->outer[n]];
    own.noalias() -= front->lower.bottomRows(outer.size()).transpose() * outer;
    front->lower.topRows(front->own()).triangularView<Eigen::Lower>().transpose().solveInPlace(own);
  }
  std::fill(z, z + parts.unknown_of.size(), 0.0);
  for (std::size_t u = 0; u < parts.component_of.size(); ++u) {
    z[parts.component_of[u]] = x[Eigen::Index(u)];
  }
}

std::size_t SparseFactor::entry_count() const {
  std::size_t sum = 0;
  for (const Front& front : m_parts->fronts) {
    const std::size_t own = std::size_t(front.own());
    sum += own * (own + 1) / 2 + own * front.outer.size();
  }
  return sum;
}

}  // namespace supple
