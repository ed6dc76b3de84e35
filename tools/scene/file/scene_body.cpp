#include "tools/scene/file/scene_body.h"

#include <algorithm>

#include "volumes/io/mesh/mesh_writer.h"

namespace supple::tools {

Fields fields(SceneBody& body) {
  Fields all = supple::fields(body.setup);
  all.push_back(Field("output", body.output, "Mesh to write after the last step")
                    .shown_as("FILE")
                    .otherwise(""));
  return all;
}

std::vector<SceneBody> read_bodies(Table& root) {
  std::vector<SceneBody> bodies;
  for (Table& table : root.tables("body")) {
    SceneBody body;
    body.setup.place = table.place();
    table.read(fields(body));
    const std::string& name = body.setup.name;
    if (name.empty()) table.fail("name", "an empty name", "one by which steps name the body");
    if (body.setup.path.empty()) table.fail_missing("path", "the path of a mesh");
    const bool is_twice = std::any_of(bodies.begin(), bodies.end(), [&](const SceneBody& other) {
      return other.setup.name == name;
    });
    if (is_twice) table.fail("name", "\"" + name + "\" twice", "a name of its own");
    if (!body.output.empty()) {
      require_mesh_name(body.output, table.place("output"), table.full_name("output"));
    }
    table.finish();
    bodies.push_back(std::move(body));
  }
  return bodies;
}

void add_bodies(const std::vector<SceneBody>& bodies, Session& session) {
  for (const SceneBody& body : bodies) session.add(body.setup);
}

}  // namespace supple::tools
