// Shapes that springs meet, from the tables of `contact = [ … ]` in a step of a scene.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "lib/model/spring_motion.h"
#include "tools/scene/toml_table.h"

namespace supple::tools {

struct ContactShape {
  DrivenCollider driven;
  nlohmann::ordered_json settings;  // its table; a mesh by its name without folder
};

/// The tables of the key. Throws InputError as TomlTable, and as read_mesh and MeshSurface.
std::vector<ContactShape> read_contacts(TomlTable& step, const std::string& key);

}  // namespace supple::tools
