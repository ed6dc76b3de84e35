#include "lib/fem/voxel/voxel_systems.h"

#include "lib/fem/voxel/fem_results.h"

namespace supple {

namespace {

/// The tangent at a state, and the cycle of the stiffness at rest.
class TangentSystem final : public LinearSystem {
 public:
  TangentSystem(const FiniteStrain& strain, const std::vector<double>& u, double part,
                NodeTurns turns, Multigrid& multigrid)
      : m_strain(strain), m_u(u), m_part(part), m_turns(std::move(turns)), m_multigrid(multigrid) {}

  void add(const float* x, double* y) const override {
    m_strain.add_tangent(m_u.data(), x, y, m_part);
  }
  void subtract(const double* x, double* y) const override {
    m_strain.subtract_tangent(m_u.data(), x, y, m_part);
  }
  void precondition(float* r, float* z, const Progress* progress) override {
    m_turns.turn_back(r);
    m_multigrid.cycle(r, z, progress);
    m_turns.turn(z);
  }
  std::size_t bytes() const override { return m_turns.bytes(); }

 private:
  const FiniteStrain& m_strain;
  const std::vector<double>& m_u;
  double m_part;  // of swellings
  NodeTurns m_turns;
  Multigrid& m_multigrid;
};

}  // namespace

std::unique_ptr<LinearSystem> FiniteVoxels::tangent_at(const std::vector<double>& u_mm,
                                                       double part) const {
  return std::make_unique<TangentSystem>(m_strain, u_mm, part,
                                         NodeTurns(m_mesh, m_material, m_held, u_mm), m_multigrid);
}

double FiniteVoxels::largest_turn_deg(const std::vector<double>& u_mm) const {
  return largest_motion(m_mesh, m_material, u_mm).rotation_deg;
}

}  // namespace supple
