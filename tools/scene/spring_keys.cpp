#include "tools/scene/spring_keys.h"

#include <filesystem>

#include <nlohmann/json.hpp>

#include "lib/springs/mesh_surface.h"

namespace supple::tools {

namespace {

Vec3d point_of(TomlTable& table, const char* key) {
  return table.require(table.vector(key), key, "[x, y, z] in LPS mm");
}

double radius_of(TomlTable& table) {
  return table.require(table.positive("radius", "mm"), "radius", "a number of mm");
}

Shape read_sphere(TomlTable& table) {
  return SphereShape{point_of(table, "centre"), radius_of(table)};
}

Shape read_plane_shape(TomlTable& table) {
  const Vec3d point = point_of(table, "point"), normal = point_of(table, "normal");
  if (normal == Vec3d(0)) table.fail("normal", "[0, 0, 0]", "a direction");
  return PlaneShape{point, normal.normalized()};
}

Shape read_capsule(TomlTable& table) {
  const Vec3d from = point_of(table, "from"), to = point_of(table, "to");
  return CapsuleShape{from, to, radius_of(table)};
}

Shape read_box_shape(TomlTable& table) {
  const Vec3d centre = point_of(table, "centre"), size = point_of(table, "size");
  for (int c = 0; c < 3; ++c) {
    if (!(size[c] > 0)) table.fail("size", number_text(size[c]), "three lengths above 0 mm");
  }
  const Vec3d half = size / 2;
  return BoxShape{centre, {Vec3d(half.x, 0, 0), Vec3d(0, half.y, 0), Vec3d(0, 0, half.z)}};
}

struct ShapeKind {
  const char* key;
  Shape (*read)(TomlTable& table);
};
constexpr ShapeKind kKinds[] = {{"sphere", read_sphere},
                                {"plane", read_plane_shape},
                                {"capsule", read_capsule},
                                {"box", read_box_shape}};

Shape read_shape(TomlTable& table) {
  const char* expected = "one of sphere, plane, capsule, box and mesh";
  std::vector<const char*> given;
  for (const ShapeKind& kind : kKinds) {
    if (table.has(kind.key)) given.push_back(kind.key);
  }
  if (table.has("mesh")) given.push_back("mesh");
  if (given.empty()) table.fail_missing("sphere", expected);
  if (given.size() > 1) table.fail(given[1], "several shapes", expected);
  for (const ShapeKind& kind : kKinds) {
    auto described = table.table(kind.key);
    if (!described) continue;
    const Shape shape = kind.read(*described);
    described->finish();
    return shape;
  }
  const std::string path = table.require(table.path("mesh"), "mesh", "the path of a mesh");
  return MeshShape{std::make_shared<MeshSurface>(read_mesh(path))};
}

/// Adds a shape and its table, a mesh by its name without folder.
void read_contact(TomlTable& table, SpringStep& step) {
  table.know({"sphere", "plane", "capsule", "box", "mesh", "by", "thickness", "friction"});
  nlohmann::ordered_json settings = nlohmann::ordered_json::parse(table.json());
  if (const auto mesh = table.path("mesh")) {
    settings["mesh"] = std::filesystem::path(*mesh).filename().string();
  }
  DrivenCollider driven;
  driven.collider.shape = read_shape(table);
  driven.collider.thickness_mm = table.not_negative("thickness", "mm").value_or(0);
  driven.collider.friction = table.not_negative("friction").value_or(0);
  driven.by_mm = table.vector("by").value_or(Vec3d(0));
  table.finish();
  step.motion.colliders.push_back(std::move(driven));
  step.contacts.push_back(settings.dump());
}

}  // namespace

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
  if (step.time_s / step.motion.step_s > SpringStep::kMostSteps) {
    table.fail(
        "time",
        number_text(step.time_s) + " s in steps of " + number_text(step.motion.step_s) + " s",
        "at most " + number_text(SpringStep::kMostSteps) + " steps");
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
    if (*steps < 1 || *steps > std::int64_t(SpringStep::kMostSteps)) {
      table.fail("steps", std::to_string(*steps), "1 to " + number_text(SpringStep::kMostSteps));
    }
    step.most_steps = int(*steps);
  }
  step.structural_n_m = table.not_negative("structural", "N/m");
  step.shear_n_m = table.not_negative("shear", "N/m");
  step.bending_n_m = table.not_negative("bending", "N/m");
  step.mass_damping_per_s = table.not_negative("mass_damping", "per second").value_or(0);
  for (TomlTable& contact : table.table_or_tables("contact")) read_contact(contact, step);
  table.finish();
  return step;
}

}  // namespace supple::tools
