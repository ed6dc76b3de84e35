// A model of tetrahedra and sheets at finite strain, as Newton's method takes it (newton.h). The
// tangent is put together anew for each system, with incomplete Cholesky factors of its own.
#pragma once

#include <memory>
#include <vector>

#include "lib/fem/newton.h"
#include "lib/fem/tet/finite_sheets.h"
#include "lib/fem/tet/finite_volumes.h"
#include "lib/fem/tet/tet_fem.h"

namespace supple {

class FiniteTets final : public NonlinearSystem {
 public:
  /// The model and what is held must outlive this. `swelling_kpa` is per element, or empty.
  FiniteTets(const TetModel& model, const HeldBits& held, std::vector<double> swelling_kpa);

  StrainEnergy add_forces(const double* u, double* force, double part) const override;
  BlockCsr tangent(const std::vector<double>& u_mm, double part) const;
  std::unique_ptr<LinearSystem> tangent_at(const std::vector<double>& u_mm,
                                           double part) const override;
  double largest_turn_deg(const std::vector<double>& u_mm) const override;
  std::size_t bytes() const { return m_volumes.bytes() + m_sheets.bytes(); }

 private:
  const TetModel& m_model;
  const HeldBits& m_held;
  FiniteVolumes m_volumes;
  FiniteSheets m_sheets;
};

}  // namespace supple
