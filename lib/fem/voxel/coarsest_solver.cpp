#include "lib/fem/voxel/coarsest_solver.h"

#include <Eigen/SparseCholesky>

#include "volumes/base/error.h"

namespace supple {

namespace {

using Ldlt = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

/// Parts of its diagonal that are added to the matrix. A coarse cell that few voxels fill, or held
/// nodes surround, has motions that move next to nothing of what is free: their pivots are lost in
/// rounding. A preconditioner may add to them; the least that makes all pivots positive is taken.
constexpr double kLeastShift = 1e-11, kMostShift = 1e-3;

bool is_positive_definite(const Ldlt& factor) {
  return factor.info() == Eigen::Success && (factor.vectorD().array() > 0).all();
}

}  // namespace

struct CoarsestSolver::Factor {
  std::vector<int> unknown_of;  // per component of a node, or -1
  int unknowns = 0;
  Ldlt ldlt;
};

CoarsestSolver::~CoarsestSolver() = default;
CoarsestSolver::CoarsestSolver(CoarsestSolver&&) noexcept = default;
CoarsestSolver& CoarsestSolver::operator=(CoarsestSolver&&) noexcept = default;

CoarsestSolver::CoarsestSolver(const BlockMatrix<double>& matrix)
    : m_factor(std::make_unique<Factor>()) {
  Factor& factor = *m_factor;
  const std::vector<double> diagonal = matrix.diagonal();
  factor.unknown_of.assign(diagonal.size(), -1);
  for (std::size_t n = 0; n < diagonal.size(); ++n) {
    if (diagonal[n] > 0) factor.unknown_of[n] = factor.unknowns++;
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t row = 0; row < matrix.rows(); ++row) {
    for (std::int64_t n = matrix.row_begin[row]; n < matrix.row_begin[row + 1]; ++n) {
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
          const int i = factor.unknown_of[3 * row + a];
          const int j = factor.unknown_of[3 * std::size_t(matrix.column[n]) + b];
          if (i >= j && j >= 0) entries.emplace_back(i, j, matrix.blocks[n].value[3 * b + a]);
        }
      }
    }
  }
  Eigen::SparseMatrix<double> lower(factor.unknowns, factor.unknowns);
  lower.setFromTriplets(entries.begin(), entries.end());
  if (factor.unknowns == 0) return;
  const Eigen::VectorXd own = lower.diagonal();
  for (double shift = kLeastShift; shift <= kMostShift; shift *= 100) {
    lower.diagonal() = own * (1 + shift);
    if (is_positive_definite(factor.ldlt.compute(lower))) return;
  }
  throw Error("finite elements: a coarse matrix is not positive definite");
}

void CoarsestSolver::solve(const float* b, float* x) const {
  const Factor& factor = *m_factor;
  Eigen::VectorXd right(factor.unknowns);
  for (std::size_t n = 0; n < factor.unknown_of.size(); ++n) {
    if (factor.unknown_of[n] >= 0) right[factor.unknown_of[n]] = b[n];
  }
  const Eigen::VectorXd solution =
      factor.unknowns > 0 ? Eigen::VectorXd(factor.ldlt.solve(right)) : right;
  for (std::size_t n = 0; n < factor.unknown_of.size(); ++n) {
    x[n] = factor.unknown_of[n] < 0 ? 0.0f : float(solution[factor.unknown_of[n]]);
  }
}

std::size_t CoarsestSolver::bytes() const {
  const std::size_t entries =
      m_factor->unknowns > 0 ? std::size_t(m_factor->ldlt.matrixL().nestedExpression().nonZeros())
                             : 0;
  return entries * (sizeof(double) + sizeof(int)) + m_factor->unknown_of.capacity() * sizeof(int);
}

}  // namespace supple
