// Thousands of cuts and drags in turn, of every kind of surface.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/chainmail/ecm.h"
#include "tests/lib/cut_fixtures.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Triangles, patches, closed boxes or the boundary of a ball.
CutReport random_cut(std::mt19937& random, Body& body) {
  const Vec3d origin(body.elements.active_bounds().lo);
  const double size = std::pow(10.0, pick(random, -1, 1.2));
  const Vec3d place = origin + pick_vector(random, -1, 6);
  const auto corner = [&] { return place + pick_vector(random, -size, size); };
  switch (random() % 5) {
    case 0: {
      TriangleMesh mesh;
      const int triangles = 1 + int(random() % 4);
      for (int n = 0; n < triangles; ++n) {
        for (int k = 0; k < 3; ++k) mesh.vertices_lps_mm.push_back(corner());
        mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
      }
      return cut(body, to_world(body.geometry, mesh));
    }
    case 1: {
      const Geometry& geometry = body.geometry;
      return cut(body, PlanePatch{geometry.world_from_index(corner()),
                                  geometry.world_vector_from_index(pick_vector(random, -9, 9)),
                                  geometry.world_vector_from_index(pick_vector(random, -9, 9))});
    }
    case 2: {
      const Vec3i lo(corner()), hi(corner());
      return cut(body, to_world(body.geometry, box_mesh(Vec3d(lo), Vec3d(hi))));
    }
    case 3: {
      TriangleMesh sphere = unit_sphere(1);
      for (Vec3d& v : sphere.vertices_lps_mm) v = place + v * size;
      return cut(body, to_world(body.geometry, sphere));
    }
    default:
      return cut_boundary(body, [&](Slot slot) {
        return (Vec3d(voxel_of(body.elements, slot)) - place).length() < size;
      });
  }
}

/// Links that are left and whose limits do not hold.
int broken_links(const Body& body) {
  int broken = 0;
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    for_each_link(body.elements, body.cuts, b, [&](int axis, Slot low, Slot high) {
      const LinkSlack slack = body.slacks.slack(axis, body.classes[low], body.classes[high]);
      const Vec3i low_voxel = voxel_of(body.elements, low);
      const Vec3i high_voxel = voxel_of(body.elements, high);
      for (int c = 0; c < 3; ++c) {
        const std::int64_t stretch =
            std::int64_t(body.offset(high_voxel, c)) - body.offset(low_voxel, c);
        broken += (stretch > slack.upper[c] && slack.upper[c] < kUnlimitedSlack) ||
                  (-stretch > slack.lower[c] && slack.lower[c] < kUnlimitedSlack);
      }
    });
  }
  return broken;
}

/// Brute force over the links that the body has left, going on from `q`.
BruteForce rebuilt(Block& block, const Body& body, const BruteForce& before) {
  block.cut.assign(std::size_t(block.size()), 0);
  for_each_lattice_link(body, [&](int axis, Slot low, Slot, bool is_cut) {
    const Vec3i node = voxel_of(body.elements, low) - block.origin;
    if (is_cut) block.cut[block.index(node.x, node.y, node.z)] |= char(1 << axis);
  });
  BruteForce brute(block);
  brute.q = before.q;
  return brute;
}

}  // namespace

TEST(PropertyCuts, TenThousandRandomCutsAndDragsKeepEveryLinkValid) {
  constexpr int kBodies = cases(250), kRounds = 40;
  int cuts = 0, drags = 0, moved = 0;
  std::int64_t newly_cut = 0;
  for (int n = 0; n < kBodies && !HasFailure(); ++n) {
    std::mt19937 random(5000 + unsigned(n));
    Block block = random_block(random, {7, 6, 5});
    Body body = body_of(block);
    const bool with_oracle = n % 10 == 0;
    BruteForce brute(block);
    EcmSolver block_engine(body, Engine::block), flat_engine(body, Engine::flat);
    for (int round = 0; round < kRounds; ++round) {
      const std::int64_t before = body.cuts.count();
      const CutReport report = random_cut(random, body);
      ASSERT_EQ(body.cuts.count(), before + report.newly_cut);
      ASSERT_LE(report.newly_cut, report.crossed);
      newly_cut += report.newly_cut;
      ++cuts;
      const int node = random_element(random, block);
      std::array<std::int32_t, 3> by;
      for (std::int32_t& q : by) q = int(random() % 2000001) - 1000000;
      EcmSolver& solver = random() % 2 == 0 ? block_engine : flat_engine;
      moved += solver.drag({Handle(block.voxel(node), by)}, {}).moved > 0;
      ++drags;
      ASSERT_EQ(broken_links(body), 0) << "body " << n << " round " << round;
      if (!with_oracle) continue;
      brute = rebuilt(block, body, brute);
      brute.drag({{{node}, {by[0], by[1], by[2]}}}, {});
      for_each_element(body.elements, [&](Slot slot) {
        const Vec3i voxel = voxel_of(body.elements, slot), at = voxel - block.origin;
        for (int c = 0; c < 3; ++c) {
          ASSERT_EQ(body.offset(voxel, c), brute.q[c][block.index(at.x, at.y, at.z)]);
        }
      });
    }
  }
  std::printf("cuts %d, drags %d, links cut %lld\n", cuts, drags,
              static_cast<long long>(newly_cut));
  EXPECT_EQ(cuts, kBodies * kRounds);
  EXPECT_EQ(moved, drags);
  EXPECT_GT(newly_cut, cases(5000));
}
