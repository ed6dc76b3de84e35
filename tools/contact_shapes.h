// Shapes that springs meet, from the tables of `contact = [ … ]` in a step of a scene.
#pragma once

#include <string>
#include <vector>

#include "lib/model/spring_motion.h"
#include "tools/toml_table.h"

namespace supple::tools {

struct ContactShape {
  DrivenCollider driven;
  std::string text;  // its table, as one line of JSON
};

/// The tables of the key. Throws InputError as TomlTable, and as read_mesh and MeshSurface.
std::vector<ContactShape> read_contacts(TomlTable& step, const std::string& key);

}  // namespace supple::tools
