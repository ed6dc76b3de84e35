#include "tools/scene/contact_shapes.h"

#include <filesystem>

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

ContactShape read_contact(TomlTable& table) {
  table.know({"sphere", "plane", "capsule", "box", "mesh", "by", "thickness", "friction"});
  ContactShape contact;
  contact.settings = nlohmann::ordered_json::parse(table.json());
  if (const auto mesh = table.path("mesh")) {
    contact.settings["mesh"] = std::filesystem::path(*mesh).filename().string();
  }
  contact.driven.collider.shape = read_shape(table);
  contact.driven.collider.thickness_mm = table.not_negative("thickness", "mm").value_or(0);
  contact.driven.collider.friction = table.not_negative("friction").value_or(0);
  contact.driven.by_mm = table.vector("by").value_or(Vec3d(0));
  table.finish();
  return contact;
}

}  // namespace

std::vector<ContactShape> read_contacts(TomlTable& step, const std::string& key) {
  std::vector<ContactShape> contacts;
  for (TomlTable& table : step.table_or_tables(key)) contacts.push_back(read_contact(table));
  return contacts;
}

}  // namespace supple::tools
