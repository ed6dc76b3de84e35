#include "tools/scene/file/view_light.h"

#include <filesystem>

#include "volumes/base/error.h"
#include "volumes/field/points/material_points.h"

namespace supple::tools {

namespace {

Light read_light(Table& table) {
  Light light;
  light.is_of_camera = false;
  table.read(fields(light));
  table.finish();
  light.validate(table.place());
  return light;
}

MeshChoice read_mesh_choice(Table& table) {
  MeshChoice choice;
  choice.place = table.place();
  table.know({"path"});
  table.read(fields(choice));
  const std::string path = table.require(table.path("path"), "path", "an .stl, .ply or .obj file");
  table.finish();
  choice.file = std::filesystem::path(path).filename().string();
  choice.mesh = std::make_shared<TriangleMesh>(read_mesh(path));
  Surface{*choice.mesh, choice.rgb, choice.opacity}.validate(choice.place);
  return choice;
}

}  // namespace

Fields fields(Lighting& lighting) {
  return {
      Field("shading", lighting.model, {"none", "phong", "blinn"}, "How surfaces reflect light"),
      Field("shadows", lighting.shadows, "Volume and meshes cast shadows"),
      Field("ambient_occlusion", lighting.occlusion_radius_mm, "Darken what is enclosed")
          .unit("mm")
          .implying("10")
          .otherwise("none; 10 without a number"),
      Field("light_volume", lighting.volume_mm, "Shadows and occlusion from places so far apart")
          .unit("mm")
          .implying("3")
          .otherwise("exact"),
      Field("exposure", lighting.exposure_stops,
            "Twice as much light on all that is drawn per stop")
          .unit("stops")
          .range(-20, 20),
  };
}

Fields fields(Light& light) {
  return {
      Field("direction", light.direction, "Towards the light, any length").required(),
      Field("frame", light.is_of_camera, {"lps", "camera"},
            "Of the direction: the patient's, or right, up and to the viewer")
          .otherwise("lps"),
      Field("intensity", light.intensity, "Brightness").range(0, 100),
      Field("colour", light.rgb, "Colour"),
  };
}

Fields fields(MeshChoice& choice) {
  return {
      Field("colour", choice.rgb, "Colour"),
      Field("opacity", choice.opacity, "Share of the light that it stops").range(0, 1),
      Field("deform", choice.deform, "Made at rest, it moves along with the tissue"),
  };
}

std::vector<Light> read_lights(Table& table) {
  std::vector<Light> lights;
  for (Table& light : table.tables("light")) lights.push_back(read_light(light));
  return lights;
}

std::vector<MeshChoice> read_meshes(Table& table) {
  std::vector<MeshChoice> meshes;
  for (Table& mesh : table.tables("mesh")) meshes.push_back(read_mesh_choice(mesh));
  return meshes;
}

std::vector<Surface> surfaces_of(const std::vector<MeshChoice>& meshes,
                                 const Displacement* displacement) {
  std::vector<Surface> surfaces;
  for (const MeshChoice& choice : meshes) {
    surfaces.push_back({*choice.mesh, choice.rgb, choice.opacity});
    if (!choice.deform || displacement == nullptr) continue;
    std::vector<Vec3d>& vertices = surfaces.back().mesh.vertices_lps_mm;
    vertices = moved_along(*displacement, vertices);
  }
  return surfaces;
}

}  // namespace supple::tools
