#include "lib/session/file/spring_keys.h"

#include <filesystem>

#include "lib/contact/mesh_surface.h"
#include "volumes/base/value.h"

namespace supple {

namespace {

Field point_field(const char* key, Vec3d& point) {
  return Field(key, point, "[x, y, z] in LPS mm").required();
}

Field radius_field(double& radius_mm) {
  return Field("radius", radius_mm, "a number of mm").unit("mm").positive().required();
}

Shape read_sphere(Table& table) {
  SphereShape sphere{};
  table.read({point_field("centre", sphere.centre_mm), radius_field(sphere.radius_mm)});
  return sphere;
}

Shape read_plane_shape(Table& table) {
  PlaneShape plane{};
  table.read({point_field("point", plane.point_mm), point_field("normal", plane.normal)});
  if (plane.normal == Vec3d(0)) table.fail("normal", "[0, 0, 0]", "a direction");
  plane.normal.normalize();
  return plane;
}

Shape read_capsule(Table& table) {
  CapsuleShape capsule{};
  table.read({point_field("from", capsule.a_mm), point_field("to", capsule.b_mm),
              radius_field(capsule.radius_mm)});
  return capsule;
}

Shape read_box_shape(Table& table) {
  Vec3d centre(0), size(0);
  table.read({point_field("centre", centre),
              Field("size", size, "[x, y, z] in mm").unit("mm").positive().required()});
  const Vec3d half = size / 2;
  return BoxShape{centre, {Vec3d(half.x, 0, 0), Vec3d(0, half.y, 0), Vec3d(0, 0, half.z)}};
}

struct ShapeKind {
  const char* key;
  Shape (*read)(Table& table);
};
constexpr ShapeKind kKinds[] = {{"sphere", read_sphere},
                                {"plane", read_plane_shape},
                                {"capsule", read_capsule},
                                {"box", read_box_shape}};

Shape read_shape(Table& table) {
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

/// Keys of a table `contact`, but for its shape.
Fields contact_fields(DrivenCollider& driven) {
  return {
      Field("by", driven.by_mm, "How far the shape goes, in LPS mm"),
      Field("thickness", driven.collider.thickness_mm, "Kept free around the shape")
          .unit("mm")
          .at_least(0),
      Field("friction", driven.collider.friction, "Coulomb's coefficient").at_least(0),
  };
}

/// Adds a shape and its table, a mesh by its name without folder.
void read_contact(Table& table, SpringStep& step) {
  DrivenCollider driven;
  table.know({"sphere", "plane", "capsule", "box", "mesh"});
  table.read(contact_fields(driven));
  Value settings = table.value();
  if (const auto mesh = table.path("mesh")) {
    settings["mesh"] = std::filesystem::path(*mesh).filename().string();
  }
  driven.collider.shape = read_shape(table);
  table.finish();
  step.motion.colliders.push_back(std::move(driven));
  step.contacts.push_back(std::move(settings));
}

}  // namespace

SpringStep read_spring_step(Table& table) {
  SpringStep step;
  table.read(fields(step));
  for (const std::string& key : idle_fields(step)) {
    if (!table.has(key) || key == "minimise") continue;
    table.fail(key, key + (step.is_motion() ? " without minimise" : " beside minimise"),
               step.is_motion() ? "it with minimise = true" : "it without minimise");
  }
  if (step.time_s / step.motion.step_s > SpringStep::kMostSteps) {
    table.fail(
        "time",
        number_text(step.time_s) + " s in steps of " + number_text(step.motion.step_s) + " s",
        "at most " + number_text(SpringStep::kMostSteps) + " steps");
  }
  for (Table& contact : table.table_or_tables("contact")) read_contact(contact, step);
  table.finish();
  return step;
}

}  // namespace supple
