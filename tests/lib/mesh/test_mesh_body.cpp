// Bodies of explicit connectors, and springs on them.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/mesh/mesh_edges.h"
#include "lib/springs/mesh_springs.h"
#include "tests/lib/spring_fixtures.h"
#include "tests/lib/test_bodies.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Two triangles that share the edge 1 2.
TriangleMesh kite() {
  return {{{0, 0, 0}, {1, -1, 0}, {1, 1, 0}, {3, 0, 0}}, {{0, 1, 2}, {1, 3, 2}}};
}

}  // namespace

TEST(UnitMeshBody, EveryEdgeIsALinkOnceAndSharedOnesAreHinges) {
  const MeshBody body = make_mesh_body(kite());
  EXPECT_EQ(body.links, (std::vector<LinkNodes>{{0, 1}, {0, 2}, {1, 2}, {1, 3}, {2, 3}}));
  EXPECT_EQ(body.pos_mm, body.rest_mm);
  EXPECT_TRUE(body.velocity_mm_s.empty());
  const std::vector<Hinge> hinges = find_hinges(body.triangles);
  ASSERT_EQ(hinges.size(), 1u);
  EXPECT_EQ(hinges[0].edge, (LinkNodes{1, 2}));
  EXPECT_EQ(hinges[0].opposite, (LinkNodes{0, 3}));
  // Euler: V - E + F = 1 of a disc; three triangles at one edge make three pairs.
  const MeshBody disc = make_mesh_body(sheet(7, 5, 1));
  EXPECT_EQ(int(disc.node_count()) - int(disc.links.size()) + int(disc.triangles.size()), 1);
  EXPECT_EQ(find_hinges({{0, 1, 2}, {0, 1, 3}, {1, 0, 4}}).size(), 3u);
}

TEST(UnitMeshBody, TetrahedraHaveEdgesAsLinksAndTheirOuterFacesAsTriangles) {
  // Two tetrahedra on both sides of the face 0 1 2.
  const MeshBody body = make_tetrahedral_body(
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}}, {{0, 1, 2, 3}, {0, 1, 2, 4}});
  EXPECT_EQ(body.links.size(), 9u);
  ASSERT_EQ(body.triangles.size(), 6u);
  double volume = 0;  // of the surface, by the divergence theorem: positive when it faces outwards
  for (const TriangleNodes& t : body.triangles) {
    volume += body.rest_mm[t[0]].dot(body.rest_mm[t[1]].cross(body.rest_mm[t[2]])) / 6;
  }
  EXPECT_NEAR(volume, 1 / 3.0, 1e-12);
  // A sixth of a mm^3 each, a quarter per corner, at 1000 kg/m^3: mg / 1000.
  const SpringSystem system = make_springs(body, {});
  EXPECT_NEAR(system.mass_kg[3], 1e-6 / 24, 1e-15);
  EXPECT_NEAR(system.mass_kg[0], 2e-6 / 24, 1e-15);
}

TEST(UnitMeshBody, LinesOfANetworkAreLinksBesideTheEdges) {
  const MeshBody body = make_mesh_body(LineNetwork{kite(), {{3, 0}, {2, 1}}});
  EXPECT_EQ(body.links, (std::vector<LinkNodes>{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}));
  EXPECT_NE(input_error([&] {
              make_mesh_body(LineNetwork{kite(), {{3, 4}}});
            }).find("line 0"),
            std::string::npos);
}

TEST(UnitMeshBody, WhatIsWrongWithConnectorsIsNamed) {
  TriangleMesh mesh = kite();
  mesh.triangles[1][1] = 4;
  EXPECT_NE(input_error([&] { make_mesh_body(mesh); }).find("triangle 1: found node 4"),
            std::string::npos);
  mesh.triangles[1][1] = 1;
  EXPECT_NE(input_error([&] { make_mesh_body(mesh); }).find("twice"), std::string::npos);
  mesh = kite();
  mesh.vertices_lps_mm[2].y = NAN;
  EXPECT_NE(input_error([&] { make_mesh_body(mesh); }).find("node 2"), std::string::npos);
  EXPECT_NE(input_error([&] {
              make_network({{0, 0, 0}}, {{{0, -1}}});
            }).find("link 0"),
            std::string::npos);
}

TEST(UnitMeshBody, CornersAtOnePlaceBecomeOneVertex) {
  // STL stores every corner of both triangles anew; one triangle collapses.
  const TriangleMesh of = kite();
  TriangleMesh soup;
  for (const auto& t : of.triangles) {
    for (const int n : t) soup.vertices_lps_mm.push_back(of.vertices_lps_mm[n]);
  }
  soup.triangles = {{0, 1, 2}, {3, 4, 5}, {0, 1, 3}};
  const MergedMesh merged = merge_equal_vertices(soup);
  EXPECT_EQ(merged.mesh.vertices_lps_mm, of.vertices_lps_mm);
  EXPECT_EQ(merged.mesh.triangles, of.triangles);
  EXPECT_EQ(merged.merged_from, (std::vector<int>{0, 1, 2, 1, 3, 2}));
}

TEST(UnitMeshSprings, EdgesAndHingesBecomeSpringsWithTheirRestLengths) {
  MeshBody body = make_mesh_body(kite());
  body.pos_mm[3].z = 5;
  MeshSpringParams params;
  params.structural_n_m = 70;
  params.bending_n_m = 3;
  params.damping_n_s_m = 0.5;
  params.stiffness_damping_s = 0.01;
  params.density_kg_m3 = 1200;
  params.thickness_mm = 2;
  const SpringSystem system = make_springs(body, params);
  ASSERT_EQ(system.springs.size(), 6u);
  EXPECT_EQ(system.springs[2].rest_mm, 2);
  EXPECT_NEAR(system.springs[2].damping_n_s_m, 0.5 + 0.7, 1e-12);
  const Spring& bending = system.springs[5];
  EXPECT_EQ(bending.a, 0);
  EXPECT_EQ(bending.b, 3);
  EXPECT_EQ(bending.rest_mm, 3);  // not what it is now
  EXPECT_EQ(bending.stiffness_n_m, 3);
  // 1 and 2 mm^2, 2 mm thick: 2.4 and 4.8 mg; a third of each per corner.
  EXPECT_NEAR(system.mass_kg[0], 0.8e-6, 1e-15);
  EXPECT_NEAR(system.mass_kg[1], 2.4e-6, 1e-15);
  EXPECT_NEAR(system.mass_kg[3], 1.6e-6, 1e-15);
  EXPECT_EQ(system.pos_mm[3].z, 5);
}

TEST(UnitMeshSprings, LinksOfANetworkWeighByTheirLength) {
  MeshSpringParams params;
  params.section_mm2 = 3;
  const SpringSystem system = make_springs(
      make_network({{0, 0, 0}, {4, 0, 0}, {4, 2, 0}}, {{1, 0}, {0, 1}, {1, 2}}), params);
  EXPECT_EQ(system.springs.size(), 2u);
  EXPECT_NEAR(system.mass_kg[0], 6e-6, 1e-15);
  EXPECT_NEAR(system.mass_kg[1], 9e-6, 1e-15);
  const MeshBody alone = make_network({{0, 0, 0}, {4, 0, 0}, {9, 9, 9}}, {{0, 1}});
  EXPECT_NE(input_error([&] { make_springs(alone, {}); }).find("node 2"), std::string::npos);
  params.bending_n_m = -1;
  EXPECT_NE(input_error([&] { make_springs(make_mesh_body(kite()), params); }), "");
}

TEST(PropertyMeshSprings, AStateGoesToTheBodyAndBackWithoutLoss) {
  MeshBody body = make_mesh_body(sheet(4, 4, 1.1));
  SpringSystem system = make_springs(body, {});
  for (Vec3d& p : system.pos_mm) p *= 1.0 / 3;
  give_state(system, body);
  EXPECT_EQ(body.pos_mm, system.pos_mm);
  EXPECT_TRUE(body.velocity_mm_s.empty());  // nothing moves: no memory
  system.velocity_mm_s[5] = {1 / 3.0, 0, 0};
  give_state(system, body);
  EXPECT_EQ(body.rest_mm, make_mesh_body(sheet(4, 4, 1.1)).rest_mm);
  SpringSystem other = make_springs(body, {});
  EXPECT_EQ(other.pos_mm, system.pos_mm);
  EXPECT_EQ(other.velocity_mm_s, system.velocity_mm_s);
  MeshBody less = make_mesh_body(kite());
  EXPECT_NE(input_error([&] { give_state(system, less); }), "");
}
