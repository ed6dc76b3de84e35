// Surface along which a step cuts the body: a triangle mesh from a file, a plane patch or a drawn
// curve from a scene, or around a label.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/body/body.h"
#include "lib/session/step.h"
#include "volumes/base/progress.h"
#include "volumes/base/value.h"
#include "volumes/io/mesh/triangle_mesh.h"

namespace supple {

/// Reads the mesh; throws InputError as read_mesh.
CutSurface mesh_cut(const std::string& path);

CutSurface label_cut(std::int32_t label, const std::string& place);

/// Cuts the body along all surfaces and returns how many links that removed. Warns of a surface
/// that crosses no link. Throws InputError for a label that no element has.
std::int64_t apply_cuts(Body& body, const BrickValues& labels,
                        const std::vector<CutSurface>& surfaces, Progress* progress);

/// Returns the surface as a journal records it.
Value settings_value(const CutSurface& surface);

}  // namespace supple
