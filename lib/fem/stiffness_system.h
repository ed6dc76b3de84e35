// The linear stiffness, or K + c M, and its multigrid cycle as a system of equations.
#pragma once

#include "lib/fem/conjugate_gradients.h"
#include "lib/fem/hex_operator.h"
#include "lib/fem/multigrid.h"

namespace supple {

class StiffnessSystem final : public LinearSystem {
 public:
  /// Both must outlive this.
  StiffnessSystem(const HexOperator& stiffness, Multigrid& multigrid)
      : m_stiffness(stiffness), m_multigrid(multigrid) {}

  void add(const float* x, double* y) const override { m_stiffness.add(x, y); }
  void subtract(const double* x, double* y) const override { m_stiffness.subtract(x, y); }
  void precondition(float* r, float* z, const Progress* progress) override {
    m_multigrid.cycle(r, z, progress);
  }

 private:
  const HexOperator& m_stiffness;
  Multigrid& m_multigrid;
};

}  // namespace supple
