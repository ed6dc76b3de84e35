// Where the elements of a body lie in a mesh of tetrahedra, and where nodes of the mesh lie in the
// body.
//
// A voxel whose centre is in no tetrahedron, at the rim or in a part that the mesh leaves out, goes
// with the tetrahedron of its neighbours that it is nearest to, ring by ring, as if that went on.
// Cost: some 20 ns and 20 bytes per element of the body.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "lib/body/slot_set.h"
#include "volumes/geometry/geometry.h"
#include "volumes/io/solid/solid_mesh.h"

namespace supple {

struct VoxelSite {
  std::int32_t tet = -1;          // none that hangs together with the voxel
  std::array<float, 4> weight{};  // of its corners, in sum 1; below 0 outside
};

/// Rings of voxels around the mesh that are near to it.
constexpr int kNearRings = 4;

/// Whether a voxel may go with a tetrahedron.
using SiteChoice = std::function<bool(std::size_t tet, Slot slot)>;

/// In the order of the bricks. `admits`: empty: any. `far`: the number of voxels beyond the near
/// rings; null: not asked.
std::vector<VoxelSite> voxel_sites(const SolidMesh& mesh, const Geometry& geometry,
                                   const BrickTopology& elements, const SiteChoice& admits = {},
                                   std::int64_t* far = nullptr);

/// Numbers of elements in the order of the bricks, by their slots; -1 elsewhere.
std::vector<std::int32_t> element_numbers(const BrickTopology& elements);

/// The element nearest to a place in voxels; none where it is farther than 3.5 voxels.
std::optional<Slot> nearest_slot(const BrickTopology& elements, const Vec3d& index);

}  // namespace supple
