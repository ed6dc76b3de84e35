// Faces of a solid mesh where a region ends, and whether they close.
// Cost: some 100 bytes and 0.3 us of a core per element.
#pragma once

#include <map>

#include "volumes/io/solid/solid_mesh.h"

namespace supple {

/// Unnamed sets of faces where a region ends, seen from the first; the second is 0 outside.
using RegionBorders = std::map<std::pair<std::int32_t, std::int32_t>, FaceSet>;
RegionBorders borders_of_regions(const SolidMesh& mesh);

/// Faces between elements of one region and what is outside of all (0), or another region. Squares
/// of hexahedra are two triangles each. Sets come in the order of (region, other), where the other
/// is 0 or larger; triangles are seen from outside of the first region. `names` of regions make
/// those of sets: "brain", "brain to skull"; a region without one is "region_N". Where files would
/// write two names alike, the second region's ends in its number.
std::vector<FaceSet> faces_of_regions(const SolidMesh& mesh,
                                      const std::map<std::int32_t, std::string>& names = {});

/// How the triangles of the outer surface hang together.
struct SurfaceTopology {
  std::int64_t open_edges = 0;     // in an odd number of triangles: 0 where the surface is closed
  std::int64_t pinched_edges = 0;  // in four or more: parts touch along an edge there
};
SurfaceTopology topology_of(const std::vector<std::array<std::int32_t, 3>>& triangles);

/// Parts of the mesh that share no face.
std::int64_t count_pieces(const SolidMesh& mesh);

}  // namespace supple
