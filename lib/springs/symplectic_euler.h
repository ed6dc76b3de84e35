// Symplectic Euler: velocities from the forces at hand, then positions from the new velocities.
// Order 1; cheap and, undamped, without drift of the energy; stable below a step that falls with
// the root of k / m.
//
// The limit of stability is that of small motions. Springs that are pressed together until their
// directions turn round within a substep may gain energy below it. A guard looks at the quantity
// that the method conserves in place of the energy (E. Hairer, C. Lubich, G. Wanner, Geometric
// Numerical Integration, 2006, section IX.3): with substeps of h
//   H + h/2 sum over free nodes of v.F,   F the springs' force and weight,
// which for a linear system stays the same but for the work of holders and shapes. Both are counted
// so that the sum is exact there. Once it has grown by more than a tenth of the energy, the step is
// done again with half the substep, from then on. Damping only lowers it. The guard does not see a
// barrier (cell_barrier.h) that is too stiff for the substeps: its stiffness is bounded every few
// substeps, and those of the step are halved, too.
#pragma once

#include <optional>

#include "lib/springs/integrator.h"
#include "lib/springs/stability.h"

namespace supple {

class SymplecticEuler final : public SpringIntegrator {
 public:
  struct Params {
    /// True: a step past the limit is cut into substeps of at most `safety` times it; else refused.
    bool substep = true;
    double safety = 0.9;        // in (0, 1)
    int max_substeps = 100000;  // more are refused
    double most_gain = 0.1;     // part of the energy that it may gain before a substep is halved
  };
  /// Throws InputError as validate(system) and for parameters out of range; Cancelled.
  SymplecticEuler(SpringSystem& system, const Params& params, const Progress* progress = nullptr);
  explicit SymplecticEuler(SpringSystem& system, const Progress* progress = nullptr)
      : SymplecticEuler(system, Params(), progress) {}

  /// Steps must be shorter than this (stability.h), in s.
  double stable_step_s() const { return m_limit_s; }

 private:
  /// Throws InputError naming the step and the limit when it refuses, Error when the energy grows
  /// in the shortest substeps.
  SpringStepReport advance(double dt_s) override;
  double substeps_of(double dt_s, int stiff_halvings) const;
  /// Makes the substeps; nothing where the barrier is too stiff for them.
  std::optional<SpringStepReport> run(double dt_s, double substeps);
  bool is_stable(double h);
  void move_nodes(double h);
  void touch(double h, SpringStepReport& report);
  double work_on_held(double h) const;
  /// The conserved sum in uJ, gravity against the start of the step.
  double conserved(double h);
  double present_energy() const;

  Params m_params;
  SpectralBounds m_bounds;  // of the springs
  double m_limit_s;
  int m_halvings = 0;    // of all substeps to come, by the guard
  double m_gain_uj = 0;  // of the conserved energy over its lowest so far
  double m_noise_uj;     // bound of rounding in a body at rest
  double m_work_uj = 0;  // of holders and shapes in this step
  std::vector<Vec3d> m_force, m_start, m_before_pos, m_before_velocity, m_origin;
};

}  // namespace supple
