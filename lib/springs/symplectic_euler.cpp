#include "lib/springs/symplectic_euler.h"

#include <cmath>
#include <string>

#include "lib/springs/stability.h"
#include "volumes/base/error.h"

namespace supple {

SymplecticEuler::SymplecticEuler(SpringSystem& system, const Params& params)
    : SpringIntegrator(system),
      m_params(params),
      m_limit_s(supple::stable_step_s(spectral_bounds(system))) {
  if (!(params.safety > 0 && params.safety < 1) || params.max_substeps < 1) {
    throw InputError({"", "symplectic Euler",
                      "safety " + number_text(params.safety) + ", max_substeps " +
                          std::to_string(params.max_substeps),
                      "a safety between 0 and 1 and at least one substep"});
  }
}

SpringStepReport SymplecticEuler::advance(double dt_s) {
  double substeps = 1;
  if (dt_s >= m_limit_s) {
    substeps = std::ceil(dt_s / (m_params.safety * m_limit_s));
    if (!m_params.substep || substeps > m_params.max_substeps) {
      throw InputError({"", "time step", number_text(dt_s) + " s",
                        "less than " + number_text(m_limit_s) +
                            " s, the limit of stability of symplectic Euler for these springs"});
    }
  }
  SpringStepReport report;
  report.substeps = int(substeps);
  const double h = dt_s / substeps;
  for (int n = 0; n < report.substeps; ++n) {
    place_held(n / substeps);
    report.without_direction += forces_mn(m_system, m_force, Damping::with);
    add_reactions(m_force, 1 / substeps);
    m_start = m_system.pos_mm;
    for (std::size_t i = 0; i < m_system.node_count(); ++i) {
      if (m_is_held[i]) continue;
      m_system.velocity_mm_s[i] += m_force[i] * (h / m_system.mass_kg[i]);  // eq. 3.18
      m_system.pos_mm[i] += m_system.velocity_mm_s[i] * h;                  // eq. 3.19
    }
    place_held((n + 1) / substeps);
    end_contacts(m_start, h, report);
  }
  return report;
}

}  // namespace supple
