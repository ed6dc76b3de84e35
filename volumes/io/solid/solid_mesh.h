// A mesh of tetrahedra or hexahedra as a value: what meshers make, elements compute on, and files
// of finite element programs hold.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

/// Triangles between nodes under a name: the surface of a region, or the border of two.
struct FaceSet {
  std::string name;
  std::vector<std::array<std::int32_t, 3>> triangles;  // seen from outside, counterclockwise
};

/// Elastic constants of elements.
struct SolidMaterial {
  std::string name;
  double young_kpa = 0;
  double poisson = 0;
};

/// Elements are tetrahedra first, then hexahedra; one mesh may hold both.
struct SolidMesh {
  std::vector<Vec3d> nodes_lps_mm;
  /// Corners; the fourth lies on the side to which the first three turn counterclockwise, so that
  /// volumes are positive.
  std::vector<std::array<std::int32_t, 4>> tets;
  /// Corners as VTK orders them: four around the bottom, four around the top.
  std::vector<std::array<std::int32_t, 8>> hexes;
  std::vector<std::int32_t> region_of;    // label per element
  std::vector<std::int32_t> material_of;  // index into materials per element, -1: none; or empty
  std::vector<SolidMaterial> materials;
  std::vector<FaceSet> faces;

  std::size_t element_count() const { return tets.size() + hexes.size(); }
};

}  // namespace supple
