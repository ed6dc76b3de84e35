// Parameters of a motion by springs, or of a minimum of their energy, and the report of a step.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/contact/collider_contact.h"

namespace supple {

enum class SpringMethod { symplectic, implicit, xpbd, projective };

const char* name_of(SpringMethod method);
/// The method of that name; none for an unknown one.
std::optional<SpringMethod> spring_method(const std::string& name);
/// The names of all methods, in the order of the enumerators.
const std::vector<std::string>& spring_method_names();

/// A shape that no node enters. During each move it goes `by_mm` on, evenly, or stays.
struct DrivenCollider {
  Collider collider;
  Vec3d by_mm{0, 0, 0};
};

struct MotionParams {
  /// True: down to the minimum of the energy, without time; else by an integrator, in time steps.
  bool minimise = false;
  SpringMethod method = SpringMethod::implicit;
  double step_s = 0.01;
  double tolerance_mn = 1e-3;  // of a minimum: largest force that is left on a free node
  Vec3d gravity_m_s2{0, 0, 0};
  std::vector<DrivenCollider> colliders;  // of a motion

  /// Throws InputError: a step or tolerance that is not positive, gravity or a way of a collider
  /// that is not finite, colliders beside a minimum, as validate() of a collider.
  void validate() const;
};

struct SpringStepReport {
  int substeps = 0;
  int halvings = 0;           // of substeps, for the energy guard or a stiff barrier
  int iterations = 0;         // Newton steps, sweeps or back-solves, all substeps together
  double residual_mn = 0;     // largest force on a node that an implicit solver left
  int contacts = 0;           // nodes that touched a shape, summed over substeps
  double penetration_mm = 0;  // deepest that contact left
  int without_direction = 0;  // springs of length 0 that were met

  /// Adds a report: counts are added, the largest residual and penetration stay.
  SpringStepReport& operator+=(const SpringStepReport& next);
};

}  // namespace supple
