// Lattice cleaving: conforming tetrahedra of one or several labels, from a lattice whose vertices
// near borders are moved onto them and whose other tetrahedra are cut where labels meet: on edges
// between two labels, in faces among three, within among four.
//
// One label alone makes this isosurface stuffing: for any function whatever, in a uniform lattice,
// dihedral angles are between 10.7 and 164.8 degrees, since the surface enters by labels of
// vertices and places of cuts along edges alone. The thresholds below are those of the widest
// bounds among all positions of one tetrahedron (10.76 and 164.71 degrees; a test goes through
// them). Where three or more labels meet, and where sizes of cubes change at a border, nothing is
// proven: a vertex moves only as far as its tetrahedra keep kGuardDeg, and cuts keep their distance
// from corners even where the border comes nearer. Volumes are positive in every case (tet_fan.h).
// Sources: J. R. Bronson, J. A. Levine, R. T. Whitaker, Lattice cleaving: conforming tetrahedral
// meshes of multimaterial domains with bounded quality, Proc. 21st International Meshing
// Roundtable, 2013; F. Labelle, J. R. Shewchuk, Isosurface stuffing, ACM Trans. Graphics 26 (3),
// 57, 2007. Departures: cuts that come too near to one another are held apart instead of snapped
// to each other; thresholds of 0.24999 and 0.41189, quoted for the second paper, reach 9.3 degrees.
// Cost: some 1 us of a core and 100 bytes per tetrahedron.
#pragma once

#include "lib/mesh/tets/lattice_tets.h"
#include "volumes/io/solid/solid_mesh.h"

namespace supple {

/// Angles that the mesh of one label in a uniform lattice keeps within.
constexpr double kLeastDihedralDeg = 10.7, kLargestDihedralDeg = 164.8;

/// Angles that meshes of several labels and of graded lattices were seen to keep within.
constexpr double kLeastJunctionDeg = 3, kLargestJunctionDeg = 173;

/// A vertex moves onto the border where an edge is cut nearer to it than this part of the edge.
constexpr double kWarpLong = 0.285, kWarpShort = 0.399;

/// The lattice keeps angles of at least this, and of at most 180 degrees less this.
constexpr double kGuardDeg = 12;

struct CleaveReport {
  std::int64_t lattice_vertices = 0, warped = 0, cuts = 0, held_apart = 0, in_faces = 0;
};

/// Nodes, tetrahedra and their labels; no materials or faces. The result does not depend on the
/// number of threads. Throws Cancelled.
SolidMesh cleave(const LabelField& field, const BccLattice& lattice, const LatticeTets& tets,
                 CleaveReport* report = nullptr, Progress* progress = nullptr);

}  // namespace supple
