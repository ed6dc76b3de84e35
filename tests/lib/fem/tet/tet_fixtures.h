// Meshes of tetrahedra for tests: cut cubes, and balls made of them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lib/fem/tet/tet_contact.h"
#include "lib/fem/tet/tet_fem.h"
#include "volumes/io/solid/solid_mesh.h"

namespace supple::test {

/// Rounding of patch tests.
constexpr double kRounding = 1e-12;
constexpr TetElement kTetElements[] = {TetElement::linear, TetElement::nodal_pressure,
                                       TetElement::quadratic};
/// Exact factors, to rounding.
TetParams exact_params();

/// A box of so many cubes along each axis, each cut into six tetrahedra, from the origin on.
/// Its sides are sets of faces "x-", "x+" and so on; all of them are "surface". Nodes inside are
/// moved at random by up to that part of a cube.
SolidMesh tet_block(const Vec3i& cubes, const Vec3d& size_mm, double perturbed = 0);
/// A ball around the origin: the cube of n^3 cubes, pulled onto spheres; its surface is "surface".
SolidMesh tet_ball(int n, double radius_mm);
/// A mesh of triangles alone.
SolidMesh sheet_mesh(const SolidMesh& of, const std::vector<std::string>& names);
void set_material(SolidMesh& mesh, double young_kpa, double poisson);

/// Nodes for which `where` holds.
std::vector<NodeIndex> nodes_where(const TetModel& model,
                                   const std::function<bool(const Vec3d&)>& where);
/// Holds nodes where `where` says, at what `displacement` gives there.
TetHeld held_where(const TetModel& model, const std::function<bool(const Vec3d&)>& where,
                   const std::function<Vec3d(const Vec3d&)>& displacement = nullptr);
Vec3d displacement_at(const TetSolution& solution, std::size_t node);

/// Largest difference from a field at the nodes, relative to its largest value there.
double largest_difference(const TetModel& model, const TetSolution& solution,
                          const std::function<Vec3d(const Vec3d&)>& field);

}  // namespace supple::test
