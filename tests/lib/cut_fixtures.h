// Surfaces to cut with, and the links that a cut body has left.
#pragma once

#include "lib/body/cut.h"
#include "tests/lib/brute_force.h"

namespace supple::test {

Vec3d pick_vector(std::mt19937& random, double lo, double hi);

/// The mesh with vertices given in voxels as one in LPS mm.
TriangleMesh to_world(const Geometry& geometry, TriangleMesh mesh);

/// A sphere of radius 1 as a convex polyhedron: an icosahedron, refined.
TriangleMesh unit_sphere(int refinements);

/// A closed box between two corners, faces as pairs of triangles.
TriangleMesh box_mesh(const Vec3d& lo, const Vec3d& hi);

/// `visit(axis, low, high, is_cut)` for every pair of neighbouring elements.
template <class Visit>
void for_each_lattice_link(const Body& body, Visit&& visit) {
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    for_each_link(body.elements, LinkCuts{}, b, [&](int axis, Slot low, Slot high) {
      visit(axis, low, high, body.cuts.is_cut(b, int(low % kBrickVoxels), axis));
    });
  }
}

}  // namespace supple::test
