#include "lib/session/spring_step.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "lib/model/spring_models.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/text.h"
#include "volumes/base/value.h"

namespace supple {

namespace {

LatticeSpringParams springs_of(const SpringStep& step, const Body& body) {
  LatticeSpringParams params = material_springs(body);
  params.mass_damping_per_s = step.mass_damping_per_s;
  if (!step.structural_n_m && !step.shear_n_m && !step.bending_n_m) return params;
  // The same for all tissue; damping stays the material's.
  params.class_stiffness.clear();
  params.structural_n_m = step.structural_n_m.value_or(0);
  params.shear_n_m = step.shear_n_m.value_or(0);
  params.bending_n_m = step.bending_n_m.value_or(0);
  return params;
}

void warn_of_result(const SpringStep& step, const SpringRecord& record, Progress* progress) {
  if (record.residual_mn && *record.residual_mn > step.motion.tolerance_mn) {
    warn(progress, "springs: no rest after " + with_count(record.steps, "step") + ", a force of " +
                       number_text(*record.residual_mn) + " mN is left");
  }
  if (record.links.violated == 0) return;
  warn(progress, "springs left " + with_count(record.links.violated, "link") + " of " +
                     std::to_string(record.links.links) +
                     " beyond the material's limits, by at most " +
                     number_text(record.links.worst_excess_voxels) +
                     " voxels; a later drag or relaxation projects them");
}

}  // namespace

int SpringStep::motion_steps() const {
  return std::max(1, int(std::ceil(time_s / motion.step_s * (1 - 1e-12))));
}

SpringRecord move_by_springs(const SpringStep& step, const HeldBody& held,
                             const std::vector<Handle>& handles,
                             const std::vector<SlotSet>& gripped, Progress* progress) {
  const auto begin = std::chrono::steady_clock::now();
  stage(progress, "springs");
  SpringRecord record;
  MotionParams motion = step.motion;
  const int steps = step.is_motion() ? step.motion_steps() : step.most_steps;
  if (step.is_motion()) motion.step_s = step.time_s / steps;
  VoxelSpringModel model(held, springs_of(step, held.body), motion, progress);
  record.nodes = model.system().node_count();
  record.springs = model.system().springs.size();
  record.before = model.energy();
  model.move(handles, steps, progress);
  record.steps = run_model(model, steps, progress);
  record.after = model.energy();
  if (step.is_motion()) {
    record.motion = model.motion().report();
  } else {
    record.residual_mn = model.motion().residual_mn();
  }
  record.reactions = model.reactions(gripped);
  record.collider_forces_n = model.motion().collider_forces_n();
  record.links = check_links(held.body);
  held.body.links_known_valid = record.links.violated == 0;
  held.body.beyond.reset();
  record.milliseconds = ms_since(begin);
  warn_of_result(step, record, progress);
  return record;
}

Fields fields(SpringStep& step) {
  MotionParams& motion = step.motion;
  return {
      Field("minimise", motion.minimise, "To the minimum of the energy, without time"),
      Field("time", step.time_s, "How long the body moves; handles move evenly")
          .unit("s")
          .positive()
          .recorded_as("time_s"),
      Field("step", motion.step_s, "The longest step of time")
          .unit("s")
          .positive()
          .recorded_as("step_s"),
      Field("integrator", motion.method, spring_method_names(), "Integrator of the motion"),
      Field("mass_damping", step.mass_damping_per_s, "Rayleigh's alpha")
          .unit("1/s")
          .at_least(0)
          .recorded_as("mass_damping_per_s"),
      Field("tolerance", motion.tolerance_mn, "Of a minimum: largest force left on a free node")
          .unit("mN")
          .shown_as("mN")
          .positive()
          .recorded_as("tolerance_mn"),
      Field("steps", step.most_steps, "Of a minimum: at most so many steps")
          .range(1, SpringStep::kMostSteps),
      Field("gravity", motion.gravity_m_s2, "Acceleration in LPS")
          .unit("m/s²")
          .recorded_as("gravity_m_s2"),
      Field("structural", step.structural_n_m, "Stiffness of all springs along edges")
          .unit("N/m")
          .at_least(0)
          .otherwise("the material's; 0 beside another stiffness")
          .recorded_as("structural_n_m"),
      Field("shear", step.shear_n_m, "Of springs across faces and cells")
          .unit("N/m")
          .at_least(0)
          .otherwise("the same")
          .recorded_as("shear_n_m"),
      Field("bending", step.bending_n_m, "The same of springs over two edges")
          .unit("N/m")
          .at_least(0)
          .otherwise("the same")
          .recorded_as("bending_n_m"),
  };
}

std::vector<std::string> idle_fields(const SpringStep& step) {
  if (step.is_motion()) return {"minimise", "tolerance", "steps"};
  return {"time", "step", "integrator", "mass_damping", "contact"};
}

Value settings_value(const SpringStep& step) {
  SpringStep effective = step;
  if (step.is_motion()) effective.motion.step_s = step.time_s / step.motion_steps();
  Fields recorded = fields(effective);
  const std::vector<std::string> idle = idle_fields(step);
  const auto is_idle = [&idle](const Field& field) {
    return std::find(idle.begin(), idle.end(), field.name()) != idle.end();
  };
  recorded.erase(std::remove_if(recorded.begin(), recorded.end(), is_idle), recorded.end());
  auto value = fields_value(recorded);
  for (const Value& contact : step.contacts) value["contact"].push_back(contact);
  return value;
}

}  // namespace supple
