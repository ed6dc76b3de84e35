// The mesh bodies of a scene: [[body]].
#pragma once

#include <string>
#include <vector>

#include "lib/session/deformable_mesh.h"
#include "lib/session/session.h"
#include "volumes/base/table.h"

namespace supple::tools {

struct SceneBody {
  MeshSetup setup = {};
  std::string output;  // mesh to write after the last step; empty: none
};
/// Keys of a [[body]].
Fields fields(SceneBody& body);

/// All tables [[body]] of a scene. Throws InputError as Table, for a name that two bodies have and
/// for an output of no mesh format.
std::vector<SceneBody> read_bodies(Table& root);

/// Puts them into a session. Throws InputError as Session::add().
void add_bodies(const std::vector<SceneBody>& bodies, Session& session);

}  // namespace supple::tools
