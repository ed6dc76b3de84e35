#include "lib/session/spring_step.h"

#include <chrono>
#include <cmath>

#include <nlohmann/json.hpp>

#include "volumes/base/text.h"

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
  VoxelSpringModel model(held, springs_of(step, held.body), motion);
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
  record.links = check_links(held.body);
  held.body.links_known_valid = record.links.violated == 0;
  record.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  warn_of_result(step, record, progress);
  return record;
}

std::string settings_json(const SpringStep& step) {
  const MotionParams& motion = step.motion;
  nlohmann::ordered_json json;
  if (step.is_motion()) {
    json = {{"integrator", name_of(motion.method)},
            {"time_s", step.time_s},
            {"step_s", step.time_s / step.motion_steps()},
            {"mass_damping_per_s", step.mass_damping_per_s}};
    for (const std::string& contact : step.contacts) {
      json["contact"].push_back(nlohmann::ordered_json::parse(contact));
    }
  } else {
    json = {{"minimise", true}, {"tolerance_mn", motion.tolerance_mn}, {"steps", step.most_steps}};
  }
  const Vec3d& g = motion.gravity_m_s2;
  json["gravity_m_s2"] = {g.x, g.y, g.z};
  for (const auto& [name, value] :
       {std::pair{"structural_n_m", step.structural_n_m}, std::pair{"shear_n_m", step.shear_n_m},
        std::pair{"bending_n_m", step.bending_n_m}}) {
    if (value) json[name] = *value;
  }
  return json.dump();
}

}  // namespace supple
