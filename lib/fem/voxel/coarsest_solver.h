// Direct solution on the coarsest level by Eigen's sparse L D L^T. Components without stiffness
// (all that they stand for is held) stay 0.
#pragma once

#include <cstddef>
#include <memory>

#include "lib/fem/voxel/block_matrix.h"

namespace supple {

class CoarsestSolver {
 public:
  /// Throws Error when the matrix cannot be factorised.
  explicit CoarsestSolver(const BlockMatrix<double>& matrix);
  ~CoarsestSolver();
  CoarsestSolver(CoarsestSolver&&) noexcept;
  CoarsestSolver& operator=(CoarsestSolver&&) noexcept;

  /// x = K^-1 b; three values per node.
  void solve(const float* b, float* x) const;
  std::size_t bytes() const;

 private:
  struct Factor;
  std::unique_ptr<Factor> m_factor;
};

}  // namespace supple
