#include "tools/scene/view_light.h"

#include <cctype>
#include <charconv>
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "tools/console/command.h"
#include "tools/console/parse.h"
#include "volumes/base/error.h"
#include "volumes/field/points/material_points.h"

namespace supple::tools {

namespace {

using Rgb = std::array<double, 3>;

bool read_colour(const std::string& text, Rgb& rgb) {
  if (text.size() != 7 || text[0] != '#') return false;
  for (int c = 0; c < 3; ++c) {
    int value = 0;
    const char* first = text.data() + 1 + 2 * c;
    const auto result = std::from_chars(first, first + 2, value, 16);
    if (result.ec != std::errc() || result.ptr != first + 2 || value < 0) return false;
    rgb[c] = value / 255.0;
  }
  return true;
}

std::string colour_text(const Rgb& rgb) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02X%02X%02X", unsigned(rgb[0] * 255 + 0.5),
                unsigned(rgb[1] * 255 + 0.5), unsigned(rgb[2] * 255 + 0.5));
  return text;
}

Rgb colour_or(TomlTable& table, const Rgb& fallback) {
  Rgb rgb = fallback;
  const auto text = table.string("colour");
  if (text && !read_colour(*text, rgb)) {
    table.fail("colour", "\"" + *text + "\"", "\"#RRGGBB\", hexadecimal");
  }
  return rgb;
}

Light read_light(TomlTable& table) {
  table.know({"direction", "frame", "intensity", "colour"});
  Light light;
  light.direction = table.require(table.vector("direction"), "direction", "a vector to the light");
  const std::string frame = table.string("frame").value_or("lps");
  if (frame != "lps" && frame != "camera") {
    table.fail("frame", "\"" + frame + "\"", "\"lps\" or \"camera\"");
  }
  light.is_of_camera = frame == "camera";
  light.intensity = table.number("intensity").value_or(light.intensity);
  light.rgb = colour_or(table, light.rgb);
  table.finish();
  light.validate(table.place());
  return light;
}

MeshChoice read_mesh_choice(TomlTable& table) {
  table.know({"path", "colour", "opacity", "deform"});
  MeshChoice choice;
  choice.place = table.place();
  const std::string path = table.require(table.path("path"), "path", "an .stl, .ply or .obj file");
  choice.file = std::filesystem::path(path).filename().string();
  choice.rgb = colour_or(table, choice.rgb);
  choice.opacity = table.number("opacity").value_or(choice.opacity);
  choice.deform = table.boolean("deform").value_or(false);
  table.finish();
  choice.mesh = std::make_shared<TriangleMesh>(read_mesh(path));
  Surface{*choice.mesh, choice.rgb, choice.opacity}.validate(choice.place);
  return choice;
}

/// Splits at the first ':' after `from`.
std::string take_part(const std::string& text, std::size_t& from) {
  const std::size_t colon = std::min(text.find(':', from), text.size());
  const std::string part = text.substr(from, colon - from);
  from = std::min(colon + 1, text.size());
  return part;
}

double parse_number(const std::string& option, const std::string& text) {
  double value = 0, unused = 0;
  parse_range(option, text + ",0", value, unused);
  return value;
}

}  // namespace

Light parse_light(const std::string& option, const std::string& text) {
  const std::string camera = "camera:";
  Light light;
  light.is_of_camera = text.compare(0, camera.size(), camera) == 0;
  std::size_t at = light.is_of_camera ? camera.size() : 0;
  light.direction = parse_vector(option, take_part(text, at));
  if (at < text.size()) light.intensity = parse_number(option, take_part(text, at));
  if (at < text.size() && !read_colour(text.substr(at), light.rgb)) {
    throw UsageError(to_line({"", option, "'" + text.substr(at) + "'", "a colour #RRGGBB"}));
  }
  light.validate(option);
  return light;
}

MeshChoice parse_mesh(const std::string& option, const std::string& text) {
  MeshChoice choice;
  const std::size_t colour = text.rfind(":#");
  const std::string path = text.substr(0, colour);
  if (colour != std::string::npos) {
    std::size_t at = colour + 1;
    if (!read_colour(take_part(text, at), choice.rgb)) {
      throw UsageError(to_line({"", option, "'" + text + "'", "FILE[:#RRGGBB[:OPACITY]]"}));
    }
    if (at < text.size()) choice.opacity = parse_number(option, text.substr(at));
  }
  choice.place = path;
  choice.file = std::filesystem::path(path).filename().string();
  choice.mesh = std::make_shared<TriangleMesh>(read_mesh(path));
  Surface{*choice.mesh, choice.rgb, choice.opacity}.validate(path);
  return choice;
}

ShadingModel parse_shading(const std::string& name) {
  if (name == "none") return ShadingModel::none;
  return name == "phong" ? ShadingModel::phong : ShadingModel::blinn;
}

Lighting read_lighting(TomlTable& table) {
  Lighting lighting;
  const std::string shading = table.string("shading").value_or("blinn");
  if (shading != "blinn" && shading != "phong" && shading != "none") {
    table.fail("shading", "\"" + shading + "\"", "\"blinn\", \"phong\" or \"none\"");
  }
  lighting.model = parse_shading(shading);
  for (TomlTable& light : table.tables("light")) lighting.lights.push_back(read_light(light));
  lighting.shadows = table.boolean("shadows").value_or(false);
  lighting.occlusion_radius_mm = table.number("ambient_occlusion").value_or(0);
  return lighting;
}

std::vector<MeshChoice> read_meshes(TomlTable& table) {
  std::vector<MeshChoice> meshes;
  for (TomlTable& mesh : table.tables("mesh")) meshes.push_back(read_mesh_choice(mesh));
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

void describe(const Lighting& lighting, nlohmann::ordered_json& view) {
  if (lighting.model != ShadingModel::blinn) {
    view["shading"] = lighting.model == ShadingModel::phong ? "phong" : "none";
  }
  for (const Light& light : lighting.lights) {
    view["light"].push_back(
        {{"direction", {light.direction.x, light.direction.y, light.direction.z}},
         {"frame", light.is_of_camera ? "camera" : "lps"},
         {"intensity", light.intensity},
         {"colour", colour_text(light.rgb)}});
  }
  if (lighting.shadows) view["shadows"] = true;
  if (lighting.occlusion_radius_mm > 0) view["ambient_occlusion"] = lighting.occlusion_radius_mm;
}

nlohmann::ordered_json to_json(const MeshChoice& choice) {
  return {{"path", choice.file},
          {"colour", colour_text(choice.rgb)},
          {"opacity", choice.opacity},
          {"deform", choice.deform}};
}

}  // namespace supple::tools
