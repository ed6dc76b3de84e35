// A step in which springs move the body, for a time or to rest.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/model/spring_models.h"
#include "volumes/base/fields.h"
#include "volumes/base/progress.h"
#include "volumes/base/value.h"

namespace supple {

struct SpringStep {
  MotionParams motion;
  double time_s = 0.1;          // of a motion
  int most_steps = 500;         // of a minimisation
  std::vector<Value> contacts;  // motion.colliders, for the record
  /// Stiffnesses in N/m, in place of the material's values.
  std::optional<double> structural_n_m, shear_n_m, bending_n_m;
  double mass_damping_per_s = 0;

  bool is_motion() const { return !motion.minimise; }
  /// Steps beyond this are taken for a mistake.
  static constexpr int kMostSteps = 1000000;
  /// Steps of a motion, which share its time: none longer than motion.step_s.
  int motion_steps() const;
};

struct SpringRecord {
  int steps = 0;
  std::size_t nodes = 0, springs = 0;
  ModelEnergy before, after;
  std::optional<double> residual_mn;       // of a minimisation: largest force on a free node
  std::optional<SpringStepReport> motion;  // of all steps of a motion
  LinkCheck links;                         // of the result, under ChainMail's limits
  double milliseconds = 0;
  std::vector<Reaction> reactions;       // of `gripped`
  std::vector<Vec3d> collider_forces_n;  // on the shapes in contact, LPS
};

/// Moves the body. Warns of links beyond their limits, and of a minimum that was not reached.
/// Throws InputError as VoxelSpringModel; Cancelled, the body at the last finished step.
SpringRecord move_by_springs(const SpringStep& step, const HeldBody& held,
                             const std::vector<Handle>& handles,
                             const std::vector<SlotSet>& gripped, Progress* progress);

/// Keys of `springs = { … }` in a scene, but for its shapes in contact.
Fields fields(SpringStep& step);
/// The fields without effect: those of a motion in a minimisation, and the other way round.
std::vector<std::string> idle_fields(const SpringStep& step);

/// Returns the step as a journal records it, without fields that have no effect.
Value settings_value(const SpringStep& step);

}  // namespace supple
