// The report of `supple mesh` about a mesh, as values and for people.
#pragma once

#include <cstdint>
#include <map>

#include "lib/mesh/tets/make_solid.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// Elements, angles, aspect, volumes beside those of the voxels, and the surface; per region where
/// there are several. `region_voxels`: voxels of every region.
Value mesh_report(const SolidMesh& mesh, const VoxelMask& mask,
                  const std::map<std::int32_t, std::int64_t>& region_voxels);

void print_mesh_report(const Value& report);

}  // namespace supple::tools
