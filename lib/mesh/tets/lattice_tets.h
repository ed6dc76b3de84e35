// Tetrahedra of a body-centred cubic lattice around a body, of cubes in several sizes: the octree
// of isosurface stuffing, whose cubes touch none of less than half or more than twice their size.
//
// Between two cubes of one size lie four tetrahedra around their face, or eight where a smaller
// cube halves an edge of it; between a cube and one of twice its size four, two on each side.
// Source: F. Labelle, J. R. Shewchuk, Isosurface stuffing, 2007, section 3.1.
// Cost: some 0.3 us and 100 bytes per tetrahedron, on one core.
#pragma once

#include "lib/mesh/tets/bcc_lattice.h"
#include "lib/mesh/tets/label_field.h"

namespace supple {

struct LatticeGrading {
  int coarser = 0;  // cubes inside have up to 2^coarser times the lattice's edge
  int finer = 0;    // cubes at voxels of `fine` have the lattice's edge over 2^finer
  const VoxelMask* fine = nullptr;
};

struct LatticeTets {
  /// Places in halves of the lattice's edges over `per_half`.
  int per_half = 1;
  std::vector<LatticePlace> places;
  std::vector<std::array<std::int32_t, 4>> tets;  // of positive volume
  bool is_uniform = true;
};

/// All tetrahedra of which a part may be inside, and some around.
LatticeTets lattice_tets(const LabelField& field, const BccLattice& lattice,
                         const LatticeGrading& grading = {});

}  // namespace supple
