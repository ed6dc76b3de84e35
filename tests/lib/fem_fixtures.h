// Bodies, an assembled stiffness matrix and loads for the tests of lib/fem.
#pragma once

#include <functional>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "lib/fem/dynamics/mass.h"
#include "lib/fem/voxel/fem.h"
#include "tests/lib/test_bodies.h"
#include "volumes/base/units.h"

namespace supple::test {

/// A block of n^3 voxels of so many mm along each axis.
Body fem_cube(int n, double spacing_mm = 1);
/// The voxels of n^3 for which it is not negative, which is their class.
Body fem_body(int n, const std::function<int(const Vec3i&)>& class_of, double spacing_mm = 1);

/// A random shape with cuts, classes and a sheared geometry, sometimes left-handed.
Body random_fem_body(std::mt19937& random, const Vec3i& max_dims);
/// Moduli over three decades, nu between -0.3 and 0.49.
ElasticTable random_elastic(std::mt19937& random);

SlotSet elements_in(const Body& body, const IndexBox& box);
/// All elements hold the nodes for which `where` says so.
HeldElements hold_where(const Body& body, std::function<bool(const Vec3d&)> where,
                        std::function<Vec3d(const Vec3d&)> displacement_mm = nullptr);

/// Written without the library's: nodes by a search among the elements around each corner, B and D
/// matrices at 2^3 Gauss points (with the mean dilatation put into B), and one entry at a time.
/// Rows are numbered as the nodes of `mesh`, which are checked to join the same corners.
Eigen::SparseMatrix<double> assembled_stiffness(const Body& body, const HexMesh& mesh,
                                                const ElasticTable& elastic,
                                                const ElementChoice& choice);

/// Mass matrix in kg, by 2^3 Gauss points per element.
Eigen::MatrixXd assembled_mass(const FemModel& model, const MassDensities& density);
/// Rows and columns of components that are not held.
Eigen::MatrixXd free_part(const Eigen::MatrixXd& matrix, const HeldBits& held);

/// Corners of the coarser mesh's element around a node.
Corners corners_around(const HexMesh& fine, const HexMesh& coarse, const Coarsening& coarsening,
                       NodeIndex node);

MassDensities even_density(double kg_m3);

/// Orders of errors whose steps are halved.
std::vector<double> orders_of(const std::vector<double>& errors);

std::vector<double> random_values(std::mt19937& random, std::size_t count);

}  // namespace supple::test
