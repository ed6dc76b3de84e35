// Interface of all integrators of a spring system: one step, its report, and the forces on held
// nodes.
//
// | integrator         | stable for          | conserves          | cost of a step         |
// |--------------------|---------------------|--------------------|------------------------|
// | SymplecticEuler    | dt below a limit    | energy, on average | springs, per substep   |
// | ImplicitEuler      | any dt              | momentum; damps    | a sparse LDLT or CG    |
// | Xpbd               | any dt              | momentum; damps    | sweeps, per substep    |
// | ProjectiveDynamics | any dt              | momentum; damps    | back-solves            |
//
// All are of order 1 and end a step with pos = start + dt * velocity. Everything runs on one thread
// in a fixed order, but for CG: results are the same bits whatever the number of threads.
#pragma once

#include <vector>

#include "lib/springs/spring_report.h"
#include "lib/springs/spring_system.h"
#include "volumes/base/progress.h"

namespace supple {

/// Moves one system. Positions, velocities, gravity, colliders and the targets of held nodes may
/// change between steps; masses, springs and which nodes are held may not (make a new one).
class SpringIntegrator {
 public:
  /// Throws InputError as validate(system).
  explicit SpringIntegrator(SpringSystem& system);
  virtual ~SpringIntegrator() = default;
  SpringIntegrator(const SpringIntegrator&) = delete;
  SpringIntegrator& operator=(const SpringIntegrator&) = delete;

  /// Makes one step of dt_s seconds. Held nodes move to their targets at constant speed, and stand
  /// still when these stay. Throws InputError when dt is not positive or not finite, and Cancelled
  /// when `progress` cancels: whatever is thrown, the system is as it was before the step.
  SpringStepReport step(double dt_s, const Progress* progress = nullptr);

  /// The force with which the body pulls at each held node's holder, in N, in the order of
  /// SpringSystem::held: springs, damping and weight less inertia, mean over the last step.
  const std::vector<Vec3d>& reactions_n() const { return m_reactions_n; }
  SpringEnergy energy() const { return supple::energy(m_system); }

 protected:
  /// Makes one step without the common part: held nodes and reactions.
  virtual SpringStepReport advance(double dt_s) = 0;

  /// The progress of this step, to be polled every few milliseconds.
  const Progress* progress() const { return m_progress; }
  /// Restores positions, velocities and reactions of the start of this step; nodes leave shapes.
  ContactReport begin_again();

  /// Sets positions and velocities of held nodes at `part` (0…1) of the present step.
  void place_held(double part);
  /// Adds the present forces of the springs at held nodes (`force` in mN, all nodes) to the mean,
  /// by `weight`.
  void add_reactions(const std::vector<Vec3d>& force, double weight);
  /// Resolves and counts contact at the end of a substep.
  void end_contacts(const std::vector<Vec3d>& start_mm, double dt_s, SpringStepReport& report);

  SpringSystem& m_system;
  std::vector<char> m_is_held;  // per node

 private:
  std::vector<Vec3d> m_reactions_n;
  std::vector<Vec3d> m_held_start, m_held_velocity;
  std::vector<Vec3d> m_first_pos, m_first_velocity, m_first_reactions_n;  // of this step
  const Progress* m_progress = nullptr;
};

/// Steps until `count` are done or `progress` cancels (throws Cancelled, between two steps); the
/// reports added up, the largest residual and penetration kept.
SpringStepReport run_steps(SpringIntegrator& integrator, double dt_s, int count,
                           Progress* progress = nullptr);

}  // namespace supple
