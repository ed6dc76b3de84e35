#include "tools/scene/spring_step.h"

#include <chrono>
#include <cmath>

namespace supple::tools {

namespace {

/// Steps beyond this are taken for a mistake.
constexpr double kMostSteps = 1e6;

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

nlohmann::ordered_json to_json(const ModelEnergy& energy) {
  return {{"elastic", energy.elastic_j},
          {"kinetic", energy.kinetic_j},
          {"gravity", energy.gravity_j},
          {"total", energy.total_j()}};
}

void warn_of_result(const SpringStep& step, const SpringRecord& record, Console& console) {
  if (record.residual_mn && *record.residual_mn > step.motion.tolerance_mn) {
    console.warn("springs: no rest after " + with_count(record.steps, "step") + ", a force of " +
                 number_text(*record.residual_mn) + " mN is left");
  }
  if (record.links.violated == 0) return;
  console.warn("springs left " + with_count(record.links.violated, "link") + " of " +
               std::to_string(record.links.links) + " beyond the material's limits, by at most " +
               number_text(record.links.worst_excess_voxels) +
               " voxels; a later drag or relaxation projects them");
}

}  // namespace

int SpringStep::motion_steps() const {
  return std::max(1, int(std::ceil(time_s / motion.step_s * (1 - 1e-12))));
}

SpringStep read_spring_step(TomlTable& table) {
  SpringStep step;
  table.know({"minimise", "time", "step", "integrator", "gravity", "tolerance", "steps",
              "structural", "shear", "bending", "mass_damping", "contact"});
  const bool to_rest = table.boolean("minimise").value_or(false);
  if (to_rest) step.motion.goal = MotionParams::Goal::minimum;
  // A key of the other goal would be without effect.
  const std::vector<const char*> idle =
      to_rest ? std::vector<const char*>{"time", "step", "integrator", "mass_damping", "contact"}
              : std::vector<const char*>{"tolerance", "steps"};
  for (const char* key : idle) {
    if (!table.has(key)) continue;
    table.fail(key, std::string(key) + (to_rest ? " beside minimise" : " without minimise"),
               to_rest ? "it without minimise" : "it with minimise = true");
  }
  if (const auto time = table.positive("time", "seconds")) step.time_s = *time;
  if (const auto dt = table.positive("step", "seconds")) step.motion.step_s = *dt;
  if (step.time_s / step.motion.step_s > kMostSteps) {
    table.fail(
        "time",
        number_text(step.time_s) + " s in steps of " + number_text(step.motion.step_s) + " s",
        "at most " + number_text(kMostSteps) + " steps");
  }
  if (const auto name = table.string("integrator")) {
    const auto method = spring_method(*name);
    if (!method) table.fail("integrator", "\"" + *name + "\"", spring_method_names());
    step.motion.method = *method;
  } else if (table.has("contact")) {
    // The others solve a step as if there were no shapes, and move nodes out afterwards.
    step.motion.method = SpringMethod::xpbd;
  }
  if (const auto gravity = table.vector("gravity")) step.motion.gravity_m_s2 = *gravity;
  if (const auto tolerance = table.positive("tolerance", "mN")) {
    step.motion.tolerance_mn = *tolerance;
  }
  if (const auto steps = table.integer("steps")) {
    if (*steps < 1 || *steps > std::int64_t(kMostSteps)) {
      table.fail("steps", std::to_string(*steps), "1 to " + number_text(kMostSteps));
    }
    step.most_steps = int(*steps);
  }
  step.structural_n_m = table.not_negative("structural", "N/m");
  step.shear_n_m = table.not_negative("shear", "N/m");
  step.bending_n_m = table.not_negative("bending", "N/m");
  step.mass_damping_per_s = table.not_negative("mass_damping", "per second").value_or(0);
  for (ContactShape& contact : read_contacts(table, "contact")) {
    step.motion.colliders.push_back(std::move(contact.driven));
    step.contacts.push_back(std::move(contact.settings));
  }
  table.finish();
  return step;
}

SpringRecord move_by_springs(const SpringStep& step, const HeldBody& held,
                             const std::vector<Handle>& handles,
                             const std::vector<SlotSet>& gripped, Console& console) {
  const auto begin = std::chrono::steady_clock::now();
  console.stage("springs");
  SpringRecord record;
  MotionParams motion = step.motion;
  const int steps = step.is_motion() ? step.motion_steps() : step.most_steps;
  if (step.is_motion()) motion.step_s = step.time_s / steps;
  VoxelSpringModel model(held, springs_of(step, held.body), motion);
  record.nodes = model.system().node_count();
  record.springs = model.system().springs.size();
  record.before = model.energy();
  model.move(handles, steps, &console);
  record.steps = run_model(model, steps, &console);
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
  warn_of_result(step, record, console);
  return record;
}

nlohmann::ordered_json settings_json(const SpringStep& step) {
  const MotionParams& motion = step.motion;
  nlohmann::ordered_json json;
  if (step.is_motion()) {
    json = {{"integrator", name_of(motion.method)},
            {"time_s", step.time_s},
            {"step_s", step.time_s / step.motion_steps()},
            {"mass_damping_per_s", step.mass_damping_per_s}};
    if (!step.contacts.empty()) json["contact"] = step.contacts;
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
  return json;
}

nlohmann::ordered_json to_json(const SpringRecord& record) {
  nlohmann::ordered_json json = {{"steps", record.steps},
                                 {"nodes", record.nodes},
                                 {"springs", record.springs},
                                 {"energy_before_j", to_json(record.before)},
                                 {"energy_after_j", to_json(record.after)}};
  if (record.residual_mn) json["residual_mn"] = *record.residual_mn;
  if (record.motion) {
    json["substeps"] = record.motion->substeps;
    json["iterations"] = record.motion->iterations;
    json["contacts"] = record.motion->contacts;
    json["penetration_mm"] = record.motion->penetration_mm;
  }
  json["links"] = record.links.links;
  json["violated"] = record.links.violated;
  json["worst_excess_voxels"] = record.links.worst_excess_voxels;
  json["springs_ms"] = record.milliseconds;
  return json;
}

}  // namespace supple::tools
