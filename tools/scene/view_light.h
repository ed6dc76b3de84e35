// Lights and meshes of a picture, as a scene's [[view]] or the options of `supple render` give
// them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "lib/material/toml_table.h"
#include "raycast/march/shading.h"
#include "raycast/scene/surface.h"
#include "volumes/field/displacement.h"

namespace supple::tools {

struct MeshChoice {
  std::string place;  // for errors
  std::string file;
  std::shared_ptr<const TriangleMesh> mesh;
  std::array<double, 3> rgb = Surface().rgb;
  double opacity = Surface().opacity;
  bool deform = false;  // given at rest, moves along with the tissue
};

/// "[camera:]X,Y,Z[:INTENSITY[:#RRGGBB]]", towards the light.
Light parse_light(const std::string& option, const std::string& text);
/// "FILE[:#RRGGBB[:OPACITY]]", read at once.
MeshChoice parse_mesh(const std::string& option, const std::string& text);
ShadingModel parse_shading(const std::string& name);

/// The keys shading, light, shadows and ambient_occlusion of a view.
Lighting read_lighting(TomlTable& table);
/// The key mesh of a view.
std::vector<MeshChoice> read_meshes(TomlTable& table);

/// Meshes as they are drawn: those that deform moved by the displacement, null: at rest.
std::vector<Surface> surfaces_of(const std::vector<MeshChoice>& meshes,
                                 const Displacement* displacement);

/// What departs from the default light.
void describe(const Lighting& lighting, nlohmann::ordered_json& view);
nlohmann::ordered_json to_json(const MeshChoice& choice);

}  // namespace supple::tools
