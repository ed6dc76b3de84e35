// ECM on mesh bodies: cases computed by hand, what is refused, extremes.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "lib/chainmail/mesh_ecm.h"
#include "tests/lib/mesh_fixtures.h"
#include "tests/lib/spring_fixtures.h"
#include "tests/lib/test_bodies.h"

using namespace supple;
using namespace supple::test;

TEST(UnitMeshEcm, AnAnchorShortensTheWholeDragByOneFraction) {
  // Links of 2 mm along x that give 0.5 mm lengthwise and 1 mm sideways.
  MeshBody body = chain_body(4, {2, 0, 0});
  MeshEcm ecm(body, {1.25, 0.5, 0.5});
  const MeshEcmReport report = ecm.drag({{{3}, {3, 2, 0}}}, {{0}});
  EXPECT_EQ(report.fraction(), 0.5);
  EXPECT_EQ(report.moved, 3);
  EXPECT_EQ(body.pos_mm[3], Vec3d(7.5, 1, 0));
  EXPECT_EQ(body.pos_mm[2], Vec3d(5, 0, 0));
  EXPECT_EQ(body.pos_mm[1], Vec3d(2.5, 0, 0));
  EXPECT_EQ(body.pos_mm[0], Vec3d(0, 0, 0));
  EXPECT_EQ(ecm.check_links().links, 3);
}

TEST(UnitMeshEcm, APushDoesNotStick) {
  MeshBody body = chain_body(3, {0, 2, 0});
  MeshEcm ecm(body, {1.25, 0.5, 0.5});
  // Both ask node 0 to come up; the push lets it go further than itself.
  ecm.drag({{{0}, {0, 0, 1}, HandleKind::push}, {{1}, {0, 0, 5}}}, {});
  EXPECT_EQ(body.pos_mm[0], Vec3d(0, 0, 4));
  EXPECT_EQ(body.pos_mm[1], Vec3d(0, 2, 5));
  EXPECT_NE(input_error([&] { ecm.drag({{{0}, {0, 0, 1}}, {{1}, {0, 0, 5}}}, {}); }), "");
}

TEST(UnitMeshEcm, ContradictionsNameThePairAndTheMissingDistance) {
  MeshBody body = chain_body(6, {2, 0, 0});
  MeshEcm ecm(body, {1.25, 0.5, 0.5});
  const std::vector<Vec3d> before = body.pos_mm;
  EXPECT_EQ(input_error([&] {
              ecm.drag({{{0}, {0, 0, 0}}, {{2, 3}, {0, 0.5, 0}}, {{5}, {2.5, 0, 0}}}, {});
            }),
            "handles 2 and 1: found targets 1.5 mm further apart along x than the links between "
            "nodes 5 and 3 allow, expected handles that agree with each other");
  EXPECT_EQ(body.pos_mm, before);
}

TEST(UnitMeshEcm, UnusableHandlesAndAnchorsAreNamedAndNothingMoves) {
  MeshBody body = chain_body(4, {2, 0, 0});
  MeshEcm ecm(body, {1.25, 0.5, 0.5});
  ecm.drag({{{0}, {1, 2, 3}}}, {});
  body.pos_mm[2].y += 5;  // broken, so that each of these projects before it fails
  const std::vector<Vec3d> before = body.pos_mm;
  const auto error_of = [&](const std::vector<MeshHandle>& handles,
                            const std::vector<NodeSet>& anchors) {
    const std::string error = input_error([&] { ecm.drag(handles, anchors); });
    EXPECT_EQ(body.pos_mm, before);
    return error;
  };
  const Vec3d up(0, 0, 1);
  EXPECT_EQ(error_of({{{0}, up}, {{}, up}}, {}),
            "handle 1: found no node, expected at least one node");
  EXPECT_EQ(error_of({{{0, 4}, up}}, {}), "handle 0: found node 4, expected an index below 4");
  EXPECT_EQ(error_of({{{0}, up}}, {{1}, {2, -1}}),
            "anchor 1: found node -1, expected an index below 4");
  EXPECT_EQ(error_of({{{0}, up}, {{1, 0}, up}}, {}),
            "handle 0 and handle 1: found node 0 in both, expected every node in one of them");
  EXPECT_EQ(error_of({{{0}, up}, {{1}, up}}, {{3}, {2, 1}}),
            "handle 1 and anchor 1: found node 1 in both, expected every node in one of them");
  EXPECT_NE(error_of({{{0}, {0, 20000, 0}}}, {}).find("handle 0: found a move by 20000 mm along y"),
            std::string::npos);
  EXPECT_NE(error_of({{{0}, {0, 0, 16383}}}, {}).find("to an offset of 16386 mm along z"),
            std::string::npos);
  EXPECT_NE(error_of({{{0}, {0, NAN, 0}}}, {}), "");
  // Anchors may overlap, and a node may be named twice.
  const MeshEcmReport report = ecm.drag({{{0, 0}, up}}, {{3}, {2, 3, 3}});
  EXPECT_EQ(report.projection.violated_links, 2);
  EXPECT_EQ(ecm.check_links().violated, 0);
  body.pos_mm[1].z = INFINITY;
  EXPECT_NE(input_error([&] { ecm.drag({{{0}, up}}, {}); }).find("node 1"), std::string::npos);
  EXPECT_NE(input_error([&] { ecm.check_links(); }).find("node 1"), std::string::npos);
  body.pos_mm.pop_back();
  EXPECT_EQ(input_error([&] {
              ecm.drag({{{0}, up}}, {});
            }),
            "positions: found 3, expected one for each of 4 nodes");
}

TEST(UnitMeshEcm, LimitsOutOfRangeAreNamed) {
  MeshBody body = chain_body(3, {2, 0, 0});
  const auto error_of = [&](const MeshLimits& limits) {
    return input_error([&] { MeshEcm(body, std::vector<MeshLimits>{{1, 1, 0}, limits}); });
  };
  EXPECT_EQ(error_of({0.9, 0.5, 0.5}), "max_length of link 1: found 0.9, expected 1 or more");
  EXPECT_NE(error_of({1.1, 0, 0.5}).find("min_length of link 1"), std::string::npos);
  EXPECT_NE(error_of({1.1, 1.1, 0.5}).find("min_length of link 1"), std::string::npos);
  EXPECT_NE(error_of({1.1, 0.9, -0.5}).find("shear of link 1"), std::string::npos);
  EXPECT_NE(error_of({INFINITY, 0.9, 0.5}), "");
  EXPECT_NE(error_of({1.1, 0.9, NAN}), "");
  EXPECT_EQ(error_of({1.1, 0.9, 0.5}), "");
  EXPECT_NE(input_error([&] {
              MeshEcm(body, std::vector<MeshLimits>{{1, 1, 0}});
            }).find("one for each of 2 links"),
            std::string::npos);
  body.rest_mm[1].z = 2e7;
  EXPECT_NE(error_of({1.1, 0.9, 0.5}).find("node 1"), std::string::npos);
}

TEST(PropertyMeshEcm, CancellingLeavesTheBodyAsItWas) {
  struct Stop final : Progress {
    void stage(std::string_view) override {}
    void update(double) override { --left; }
    bool cancelled() const override { return left <= 0; }
    int left = 2;
  } progress;
  MeshBody body = make_mesh_body(sheet(20, 20, 1));
  MeshEcm ecm(body, {1.1, 0.9, 0.1});
  body.pos_mm[7].x += 3;
  MeshBody twin = body;
  const std::vector<Vec3d> before = body.pos_mm;
  EXPECT_THROW(ecm.drag({{{30}, {9, 9, 9}}}, {}, &progress), Cancelled);
  EXPECT_EQ(body.pos_mm, before);
  ecm.drag({{{30}, {9, 9, 9}}}, {});
  MeshEcm(twin, {1.1, 0.9, 0.1}).drag({{{30}, {9, 9, 9}}}, {});
  EXPECT_EQ(body.pos_mm, twin.pos_mm);
}

TEST(PropertyMeshEcm, ACancelledProjectionLeavesNothingBehind) {
  struct Stopped final : Progress {
    void stage(std::string_view) override {}
    void update(double) override {}
    bool cancelled() const override { return true; }
  } progress;
  MeshBody body = make_mesh_body(sheet(380, 380, 1));  // so many that the engine looks
  const MeshLimits limits{1.1, 0.9, 0.1};
  MeshEcm ecm(body, limits);
  for (std::size_t n = 0; n < body.node_count(); n += 50) body.pos_mm[n].x += 1;
  EXPECT_THROW(ecm.project({}, &progress), Cancelled);
  for (std::size_t n = 0; n < body.node_count(); n += 70) body.pos_mm[n].x += 3;
  MeshBody twin = body;
  const MeshEcmReport report = ecm.drag({{{30}, {1, 2, 3}}}, {});
  const MeshEcmReport expected = MeshEcm(twin, limits).drag({{{30}, {1, 2, 3}}}, {});
  EXPECT_EQ(report.projection.violated_links, expected.projection.violated_links);
  EXPECT_EQ(report.moved, expected.moved);
  EXPECT_TRUE(body.pos_mm == twin.pos_mm);
}

TEST(ExtremesMeshEcm, FarFromTheOriginOffsetsAreStillReadBackExactly) {
  const Vec3d far(-9.9e6, 9.9e6, 5e6 + 1 / 3.0);
  MeshBody near = chain_body(30, {2, 0.5, 1}), body = near;
  for (Vec3d& p : body.rest_mm) p += far;
  body.pos_mm = body.rest_mm;
  MeshEcm ecm(body, {1.25, 0.5, 0.5});
  std::mt19937 random(1);
  for (int n = 0; n < 20; ++n) {
    const int grabbed = int(random() % 30);
    const Vec3d by(double(random() % 999983) / 65536, double(random() % 999983) / 65536, 1);
    ecm.drag({{{grabbed}, by}}, {});
    // A solver that reads the positions anew finds the same offsets: nothing to round or project.
    const std::vector<Vec3d> before = body.pos_mm;
    MeshEcm(body, {1.25, 0.5, 0.5}).project();
    ASSERT_EQ(body.pos_mm, before);
  }
  EXPECT_EQ(ecm.check_links().violated, 0);
}

TEST(ExtremesMeshEcm, NoLinksRigidLinksUnlimitedLinksAndCoincidentNodes) {
  MeshBody lone = make_network({{1, 2, 3}, {4, 5, 6}}, {});
  MeshEcm free(lone, {1.1, 0.9, 0.1});
  EXPECT_EQ(free.drag({{{0}, {16000, 0, 0}}}, {{1}}).moved, 1);
  EXPECT_EQ(lone.pos_mm[0], Vec3d(16001, 2, 3));

  MeshBody rigid = chain_body(50, {2, 1, 0.5});
  MeshEcm all(rigid, {1, 1, 0});
  EXPECT_EQ(all.drag({{{17}, {-5, 4, 3}}}, {}).moved, 50);
  EXPECT_EQ(rigid.pos_mm[49] - rigid.rest_mm[49], Vec3d(-5, 4, 3));
  EXPECT_EQ(all.drag({{{17}, {-5, 4, 3}}}, {{0}}).fraction_numerator, 0);

  MeshBody wide = chain_body(3, {2, 1, 0.5});
  MeshEcm loose(wide, {1e9, 0.5, 1e9});
  EXPECT_EQ(loose.drag({{{0}, {-16000, 16000, 0}}, {{1}, {16000, -16000, 0}}}, {{2}}).moved, 2);

  MeshBody twins = make_network({{0, 0, 0}, {0, 0, 0}, {1, 0, 0}}, {{0, 1}, {1, 2}});
  MeshEcm together(twins, {1.5, 0.5, 0.5});
  together.drag({{{0}, {0, 0, 2}}}, {});
  EXPECT_EQ(twins.pos_mm[1], Vec3d(0, 0, 2));
  EXPECT_EQ(twins.pos_mm[2], Vec3d(1, 0, 1.5));
}
