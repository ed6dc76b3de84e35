// Lights and meshes of a picture, as a scene's [[view]] or the options of `supple render` give
// them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "raycast/march/render_settings.h"
#include "raycast/scene/surface.h"
#include "volumes/base/table.h"
#include "volumes/field/offset_field.h"

namespace supple::tools {

struct MeshChoice {
  std::string place;  // for errors
  std::string file;
  std::shared_ptr<const TriangleMesh> mesh;
  Rgb rgb = Surface().rgb;
  double opacity = Surface().opacity;
  bool deform = false;  // given at rest, moves along with the tissue
};

/// Shading, shadows and ambient occlusion of a view; `light` is a list of tables.
Fields fields(Lighting& lighting);
/// Keys of a table `light`.
Fields fields(Light& light);
/// Keys of a table `mesh`, its path apart.
Fields fields(MeshChoice& choice);
/// The key light of a view. Throws InputError.
std::vector<Light> read_lights(Table& table);
/// The key mesh of a view.
std::vector<MeshChoice> read_meshes(Table& table);

/// Meshes as they are drawn: those that deform moved by the displacement, null: at rest.
std::vector<Surface> surfaces_of(const std::vector<MeshChoice>& meshes,
                                 const Displacement* displacement);

}  // namespace supple::tools
