#include "lib/fem/tet/finite_tets.h"

#include <algorithm>
#include <utility>

#include "lib/fem/tet/tet_system.h"
#include "volumes/base/units.h"

namespace supple {

FiniteTets::FiniteTets(const TetModel& model, const HeldBits& held,
                       std::vector<double> swelling_kpa)
    : m_model(model),
      m_held(held),
      m_volumes(model.volumes(), model.moduli(), std::move(swelling_kpa)),
      m_sheets(model.shells(), model.volumes().positions(), std::size_t(model.node_count())) {}

StrainEnergy FiniteTets::add_forces(const double* u, double* force, double part) const {
  StrainEnergy sum = m_volumes.add_forces(u, force, part);
  sum.energy_uj += m_sheets.add_forces(u, force);
  return sum;
}

BlockCsr FiniteTets::tangent(const std::vector<double>& u_mm, double part) const {
  BlockCsr matrix = m_model.stiffness();
  matrix.set_zero();
  m_volumes.add_tangent(u_mm.data(), part, matrix);
  m_sheets.add_tangent(u_mm.data(), matrix);
  return matrix;
}

std::unique_ptr<LinearSystem> FiniteTets::tangent_at(const std::vector<double>& u_mm,
                                                     double part) const {
  return std::make_unique<TetSystem>(tangent(u_mm, part), m_held);
}

double FiniteTets::largest_turn_deg(const std::vector<double>& u_mm) const {
  double most_rad = 0;
  for (std::size_t e = 0; e < m_model.volumes().element_count(); ++e) {
    const Matrix9 gradient = m_model.volumes().gradient_at_centre(e, u_mm);
    most_rad = std::max(most_rad, axial(gradient).length());
  }
  return most_rad * kDegreesPerRadian;
}

}  // namespace supple
