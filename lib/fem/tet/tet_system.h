// A matrix of blocks with its incomplete Cholesky factors, as conjugate gradients take them.
#pragma once

#include <memory>
#include <utility>

#include "lib/fem/operator.h"
#include "lib/fem/tet/block_csr.h"
#include "lib/fem/tet/incomplete_cholesky.h"

namespace supple {

class TetSystem final : public LinearSystem {
 public:
  /// `matrix` must outlive this.
  TetSystem(const BlockCsr& matrix, const HeldBits& held)
      : m_matrix(&matrix), m_factors(matrix, held) {}
  /// Keeps the matrix.
  TetSystem(BlockCsr&& matrix, const HeldBits& held)
      : m_own(std::make_unique<BlockCsr>(std::move(matrix))),
        m_matrix(m_own.get()),
        m_factors(*m_matrix, held) {}

  void add(const float* x, double* y) const override { m_matrix->add(x, y); }
  void subtract(const double* x, double* y) const override { m_matrix->subtract(x, y); }
  void precondition(float* r, float* z, const Progress*) override { m_factors.solve(r, z); }
  std::size_t bytes() const override {
    return m_factors.bytes() + (m_own == nullptr ? 0 : m_own->bytes());
  }
  const IncompleteCholesky& factors() const { return m_factors; }

 private:
  std::unique_ptr<BlockCsr> m_own;
  const BlockCsr* m_matrix;
  IncompleteCholesky m_factors;
};

}  // namespace supple
