// Common part of the models of springs on voxel and on mesh bodies: a spring system whose held
// nodes are driven, an integrator or a minimisation that moves it, and the forces on handles.
#pragma once

#include <memory>
#include <vector>

#include "lib/model/model.h"
#include "lib/springs/integrators.h"
#include "lib/springs/minimise.h"
#include "lib/springs/spring_report.h"

namespace supple {

/// Nodes and how far each of them goes.
struct DrivenNodes {
  std::vector<int> nodes;
  std::vector<Vec3d> by_mm;
};

class SpringMotion {
 public:
  /// Refers to the system, whose nodes and springs must not change meanwhile. Throws InputError as
  /// validate() of params and system.
  SpringMotion(SpringSystem& system, const MotionParams& params);

  /// Holds the nodes of `anchored`, and those of the handles, which go evenly over the next `steps`
  /// steps, at least 1; lets all others go. Indices in any order.
  void move(const std::vector<int>& anchored, std::vector<DrivenNodes> handles, int steps);
  /// False when a minimum is reached. Throws Cancelled, the system as it was before the step.
  bool step(const Progress* progress = nullptr);
  ModelEnergy energy() const;
  /// Reactions summed over the nodes of each set; nodes that are not held count 0. Means over the
  /// last step of time; at a minimum, and before the first step, those of springs at rest.
  std::vector<Reaction> reactions(const std::vector<std::vector<int>>& sets) const;
  /// Force on each collider in N: what the nodes that touch it press and rub on it with, mean over
  /// the last step of time. On such a node it is that of springs, damping and gravity less its mass
  /// times its acceleration; one that touches several counts for the one it is deepest in. 0 before
  /// the first step.
  std::vector<Vec3d> collider_forces_n() const;
  /// Largest force that is left on a free node; of a minimisation.
  double residual_mn() const { return m_minimiser ? m_minimiser->residual_mn() : 0; }
  const SpringStepReport& report() const { return m_report; }

 private:
  void drive();
  bool step_on(const Progress* progress);
  bool step_down(const Progress* progress);

  SpringSystem& m_system;
  MotionParams m_params;
  std::vector<DrivenNodes> m_handles;
  std::vector<std::vector<Vec3d>> m_starts;        // per handle and node
  std::vector<Shape> m_shape_starts;               // per collider
  int m_step = 0, m_steps = 1;                     // of the present move
  std::unique_ptr<SpringIntegrator> m_integrator;  // from the first step of a move on
  std::unique_ptr<Minimiser> m_minimiser;          // the same
  SpringStepReport m_report;                       // of all steps
  std::vector<Vec3d> m_velocity_before;            // the last step; empty without colliders
};

}  // namespace supple
