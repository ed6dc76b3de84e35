// Laws of unilateral contact with a fixed shell.
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/lib/fem/tet/tet_fixtures.h"
#include "tests/lib/test_bodies.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr double kRadius = 70;

/// A ball whose surface is skull but for an opening above.
SolidMesh ball_in_skull(int n, double opening_above_mm) {
  SolidMesh mesh = tet_ball(n, kRadius);
  set_material(mesh, 6, 0.45);
  FaceSet skull{"skull", {}}, opening{"opening", {}};
  for (const auto& triangle : mesh.faces[0].triangles) {
    const auto z = [&](std::size_t c) { return mesh.nodes_lps_mm[std::size_t(triangle[c])].z; };
    const bool is_open = std::min({z(0), z(1), z(2)}) > opening_above_mm;
    (is_open ? opening : skull).triangles.push_back(triangle);
  }
  mesh.faces = {skull, opening};
  return mesh;
}

TetHeld held_below(const TetModel& model) {
  return held_where(model, [](const Vec3d& x) { return x.length() > 69.9 && x.z < -62; });
}

/// How far a point is beyond the nearest of all triangles, along its normal.
double beyond(const std::vector<Vec3d>& rest, const std::vector<std::array<NodeIndex, 3>>& shell,
              const Vec3d& x) {
  double least = std::numeric_limits<double>::infinity(), result = 0;
  for (const auto& triangle : shell) {
    const auto at = [&](std::size_t c) { return rest[std::size_t(triangle[c])]; };
    const Vec3d normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    const double height = (x - at(0)).dot(normal);
    // Among planes of triangles above which the point lies.
    const Vec3d foot = x - normal * height;
    bool is_inside = true;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3d along = at((c + 1) % 3) - at(c);
      is_inside = is_inside && along.cross(foot - at(c)).dot(normal) > -1e-9;
    }
    if (!is_inside || std::abs(height) > least) continue;
    least = std::abs(height);
    result = height;
  }
  return result;
}

}  // namespace

TEST(PropertyTetContact, NothingEntersTheSkullUnderRandomLoadsAndForcesBalance) {
  std::mt19937 random(5);
  const SolidMesh mesh = ball_in_skull(4, 40);
  const TetModel model(mesh, TetElement::linear);
  const auto shell = model.parts_of_faces({"skull"});
  int parted = 0;
  for (int load = 0; load < 200; ++load) {
    TetLoads loads;
    loads.held.push_back(held_below(model));
    const Vec3d slope(pick(random, -0.015, 0.015), pick(random, -0.015, 0.015),
                      pick(random, -0.015, 0.015));
    const double mean = pick(random, -0.5, 2);
    for (const auto& tet : mesh.tets) {
      loads.swelling_kpa.push_back(mean + slope.dot(mesh.nodes_lps_mm[std::size_t(tet[0])]));
    }
    loads.gravity_m_s2 = Vec3d(pick(random, -1.5, 1.5), pick(random, -1.5, 1.5), 0);
    loads.density_kg_m3 = {1040};
    const NodeIndex pulled = NodeIndex(random() % model.place_count());
    loads.forces.push_back({pulled, Vec3d(pick(random, -100, 100), pick(random, -100, 100), 50)});
    const TetContactSolution out = solve_in_shell(model, loads, {{"skull"}, {"opening"}});
    EXPECT_LE(out.report.deepest_mm, 1e-3);
    EXPECT_LE(out.report.force_balance, 1e-6);
    for (std::size_t n = 0; n < out.nodes.size(); ++n) {
      EXPECT_GE(out.pressure_kpa[n], -1e-6 * out.report.largest_pressure_kpa);
      const std::size_t node = std::size_t(out.nodes[n]);
      const Vec3d x = mesh.nodes_lps_mm[node] + displacement_at(out.solution, node);
      EXPECT_LE(beyond(mesh.nodes_lps_mm, shell, x), 1e-3) << load << " " << node;
    }
    parted += out.report.pressing < out.report.nodes;
  }
  EXPECT_GT(parted, 50);
}

TEST(UnitTetContact, ABodyThatSwellsInAClosedSkullPressesWithItsPressure) {
  const SolidMesh mesh = ball_in_skull(6, 100);
  const TetModel model(mesh, TetElement::linear);
  TetLoads loads;
  loads.held.push_back(held_below(model));
  loads.swelling_kpa.assign(mesh.tets.size(), 2);
  const TetContactSolution out = solve_in_shell(model, loads, {{"skull"}, {}});
  EXPECT_EQ(out.report.pressing, out.report.nodes);
  for (std::size_t n = 0; n < out.nodes.size(); ++n) EXPECT_NEAR(out.pressure_kpa[n], 2, 0.2);
  double most = 0;
  for (const double u : out.solution.u_mm) most = std::max(most, std::abs(u));
  EXPECT_LE(most, 1);
}

TEST(UnitTetContact, ABodyThatShrinksPartsFromTheSkull) {
  const SolidMesh mesh = ball_in_skull(4, 100);
  const TetModel model(mesh, TetElement::linear);
  TetLoads loads;
  loads.held.push_back(held_below(model));
  loads.swelling_kpa.assign(mesh.tets.size(), -1);
  const TetContactSolution out = solve_in_shell(model, loads, {{"skull"}, {}});
  // But beside what is held, where it bulges.
  EXPECT_LT(out.report.pressing, out.report.nodes / 10);
  for (std::size_t n = 0; n < out.nodes.size(); ++n) {
    const std::size_t node = std::size_t(out.nodes[n]);
    if (mesh.nodes_lps_mm[node].z < 0) continue;
    EXPECT_EQ(out.pressure_kpa[n], 0);
    EXPECT_LT(displacement_at(out.solution, node).dot(mesh.nodes_lps_mm[node]), 0);
  }
}

TEST(UnitTetContact, OpeningsAreToldWithTheirAreasByEitherRuleOfTheRim) {
  const SolidMesh mesh = ball_in_skull(6, 40);
  const TetModel model(mesh, TetElement::linear);
  TetLoads loads;
  loads.held.push_back(held_below(model));
  loads.swelling_kpa.assign(mesh.tets.size(), 2);
  TetShellContact shell{{"skull"}, {"opening"}};
  const TetContactSolution held = solve_in_shell(model, loads, shell);
  shell.frees_rims = true;
  const TetContactSolution freed = solve_in_shell(model, loads, shell);
  ASSERT_EQ(held.report.openings.size(), 1u);
  const ShellOpening &small = held.report.openings[0], &large = freed.report.openings[0];
  EXPECT_EQ(small.name, "opening");
  EXPECT_NEAR(small.area_mm2, model.area_of_faces("opening"), 1e-9);
  EXPECT_LT(small.free_area_mm2, 0.8 * small.area_mm2);
  EXPECT_NEAR(large.free_area_mm2, large.area_mm2, 1e-9);
  const auto volume = [&](const TetContactSolution& of) {
    return model.volumes().displaced_volume_mm3(of.solution.u_mm);
  };
  EXPECT_GT(volume(freed), 1.01 * volume(held));
  EXPECT_LT(freed.report.nodes, held.report.nodes);
}

TEST(FaultTetContact, WhatNothingButTheShellHoldsIsRefused) {
  const SolidMesh mesh = ball_in_skull(4, 40);
  const TetModel model(mesh, TetElement::linear);
  EXPECT_THROW(solve_in_shell(model, {}, {{"skull"}, {}}), InputError);
  TetLoads loads;
  loads.held.push_back(held_below(model));
  EXPECT_THROW(solve_in_shell(model, loads, {{"bone"}, {}}), InputError);
}
