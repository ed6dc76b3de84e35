// Shapes and volumes of the elements of a solid mesh.
// Cost: some 0.1 us of a core per element.
#pragma once

#include <map>

#include "volumes/io/solid/solid_mesh.h"

namespace supple {

struct SolidQuality {
  double least_dihedral_deg = 180, largest_dihedral_deg = 0;  // of tetrahedra; 180, 0: none
  /// Angles of tetrahedra at a node where three regions meet, or two and the outside.
  double least_junction_deg = 180, largest_junction_deg = 0;
  std::int64_t junction_tets = 0;
  /// The longest edge over 2 sqrt(6) radii of the inner sphere in tetrahedra, over the shortest
  /// edge in hexahedra: 1 at best.
  double mean_aspect = 0, largest_aspect = 0;
  double least_volume_mm3 = 0, mean_volume_mm3 = 0, largest_volume_mm3 = 0;
  double shortest_edge_mm = 0, mean_edge_mm = 0, longest_edge_mm = 0;
  std::int64_t turned_inside_out = 0;             // volumes of 0 and below
  std::map<std::int32_t, double> volume_mm3;      // per region
  std::map<std::int32_t, std::int64_t> elements;  // per region
};

/// The mesh needs an element. Sums do not depend on the number of threads.
SolidQuality quality_of(const SolidMesh& mesh);

/// Volumes of all elements.
std::vector<double> volumes_mm3(const SolidMesh& mesh);

}  // namespace supple
