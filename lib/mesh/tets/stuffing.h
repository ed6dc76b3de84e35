// Isosurface stuffing: tetrahedra that fill a surface, from a body-centred cubic lattice whose
// vertices near the surface are moved onto it and whose other tetrahedra are cut by stencils.
//
// Source: F. Labelle, J. R. Shewchuk, Isosurface stuffing: fast tetrahedral meshes with good
// dihedral angles, ACM Trans. Graphics 26 (3), 57, 2007, uniform case. For any function whatever,
// dihedral angles are between 10.7 and 164.8 degrees, and volumes positive: the surface enters by
// signs at vertices and by places of cuts along edges alone. The thresholds below are those of the
// widest bounds among all positions of one tetrahedron (10.76 and 164.71 degrees; a test goes
// through them). Thresholds of 0.24999 and 0.41189, which are quoted for the paper, reach 9.3.
// Cost: 15 bytes per vertex of the lattice around the body, and some 1 us of a core per
// tetrahedron.
#pragma once

#include "lib/mesh/tets/bcc_lattice.h"
#include "volumes/base/progress.h"
#include "volumes/io/solid/solid_mesh.h"

namespace supple {

class MaskDistance;

/// Angles that the mesh keeps within.
constexpr double kLeastDihedralDeg = 10.7, kLargestDihedralDeg = 164.8;

/// A vertex moves onto the surface where an edge is cut nearer to it than this part of the edge.
constexpr double kWarpLong = 0.285, kWarpShort = 0.399;

struct StuffReport {
  std::int64_t lattice_vertices = 0, warped = 0, cuts = 0;
};

/// Nodes and tetrahedra where the distance is negative; no regions, materials or faces. The result
/// does not depend on the number of threads. Throws Cancelled, and InputError where nodes are more
/// than 2^31 - 1.
SolidMesh stuff_surface(const MaskDistance& distance, const BccLattice& lattice,
                        StuffReport* report = nullptr, Progress* progress = nullptr);

}  // namespace supple
