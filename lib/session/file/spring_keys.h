// The keys of `springs = { … }` in a step of a scene, with the shapes of `contact = [ … ]`.
#pragma once

#include "lib/session/spring_step.h"
#include "volumes/base/table.h"

namespace supple {

/// Throws InputError as Table, and as read_mesh and MeshSurface.
SpringStep read_spring_step(Table& table);

}  // namespace supple
