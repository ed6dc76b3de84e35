// Symplectic Euler: velocities from the forces at hand, then positions from the new velocities.
// Order 1; cheap and, undamped, without drift of the energy; stable below a step that falls with
// the root of k / m.
#pragma once

#include "lib/springs/integrator.h"

namespace supple {

class SymplecticEuler final : public SpringIntegrator {
 public:
  struct Params {
    /// Past the limit: cut the step into substeps of at most `safety` times the limit, or refuse.
    bool substep = true;
    double safety = 0.9;        // in (0, 1)
    int max_substeps = 100000;  // more are refused
  };
  /// Throws InputError as validate(system) and for parameters out of range.
  SymplecticEuler(SpringSystem& system, const Params& params);
  explicit SymplecticEuler(SpringSystem& system) : SymplecticEuler(system, Params()) {}

  /// Steps must be shorter than this (stability.h), in s.
  double stable_step_s() const { return m_limit_s; }

 private:
  /// Throws InputError naming the step and the limit when it refuses.
  SpringStepReport advance(double dt_s) override;

  Params m_params;
  double m_limit_s;
  std::vector<Vec3d> m_force, m_start;
};

}  // namespace supple
