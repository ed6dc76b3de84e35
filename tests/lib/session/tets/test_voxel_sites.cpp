// Places of voxels in a mesh of tetrahedra, inside of it and beyond, and of nodes in a body.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/mesh/tets/make_solid.h"
#include "lib/session/tets/voxel_sites.h"
#include "tests/lib/fem_fixtures.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr int kSize = 20;

/// A ball in 20^3 voxels, meshed, and a spike of one voxel's width on it, which the mesh leaves
/// out.
class UnitVoxelSites : public ::testing::Test {
 protected:
  static bool is_ball(const Vec3i& v) { return (Vec3d(v) - Vec3d(9.5)).length() < 7; }
  static bool is_spike(const Vec3i& v) { return v.x == 10 && v.y == 10 && v.z >= 10; }

  UnitVoxelSites() {
    const auto body_of = [](const auto& holds) {
      return fem_body(kSize, [&](const Vec3i& v) { return holds(v) ? 1 : -1; });
    };
    m_ball = body_of(is_ball);
    m_body = body_of([](const Vec3i& v) { return is_ball(v) || is_spike(v); });
    SolidParams params;
    params.spacing_mm = 3;
    m_mesh = make_tets(mask_of(m_ball.geometry, m_ball.elements), params);
    m_sites = voxel_sites(m_mesh, m_body.geometry, m_body.elements);
  }

  /// The value at a site of a function of the nodes.
  template <class Function>
  double value(const VoxelSite& site, const Function& function) const {
    double sum = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      const auto node = std::size_t(m_mesh.tets[std::size_t(site.tet)][c]);
      sum += double(site.weight[c]) * function(m_mesh.nodes_lps_mm[node]);
    }
    return sum;
  }

  Body m_ball, m_body;
  SolidMesh m_mesh;
  std::vector<VoxelSite> m_sites;
};

}  // namespace

TEST_F(UnitVoxelSites, ALinearFunctionIsExactInTheBallAndBoundedOnTheSpike) {
  const auto function = [](const Vec3d& x) { return 1 + 0.5 * x.x - 2 * x.y + 0.25 * x.z; };
  std::size_t n = 0, beyond = 0;
  for_each_element(m_body.elements, [&](Slot slot) {
    const Vec3i voxel = voxel_of(m_body.elements, slot);
    const VoxelSite& site = m_sites[n++];
    ASSERT_GE(site.tet, 0) << voxel;
    double sum = 0;
    for (const float weight : site.weight) {
      sum += double(weight);
      EXPECT_GE(weight, -1.001F) << voxel;
      EXPECT_LE(weight, 2.001F) << voxel;
    }
    EXPECT_NEAR(sum, 1, 1e-5) << voxel;
    if (is_ball(voxel)) {
      const Vec3d at = m_body.geometry.world_from_index(Vec3d(voxel));
      EXPECT_NEAR(value(site, function), function(at), 1e-4) << voxel;
    } else {
      ++beyond;
    }
  });
  EXPECT_GE(beyond, 2u);
}

TEST_F(UnitVoxelSites, PartsThatNothingJoinsToTheMeshHaveNoPlace) {
  const Body body = fem_body(kSize, [](const Vec3i& v) {
    return is_ball(v) || v == Vec3i(0, 0, 0) || v == Vec3i(0, 0, 1) ? 1 : -1;
  });
  std::size_t n = 0;
  const std::vector<VoxelSite> sites = voxel_sites(m_mesh, body.geometry, body.elements);
  for_each_element(body.elements, [&](Slot slot) {
    EXPECT_EQ(sites[n++].tet < 0, !is_ball(voxel_of(body.elements, slot)));
  });
}

TEST_F(UnitVoxelSites, TheNearestElementIsThatOfBruteForce) {
  for (int n = 0; n < 300; ++n) {
    const Vec3d at(std::fmod(n * 0.7312, 22.0) - 1, std::fmod(n * 1.918, 22.0) - 1,
                   std::fmod(n * 2.377, 22.0) - 1);
    double least = 1e9;
    for_each_element(m_body.elements, [&](Slot slot) {
      least = std::min(least, (Vec3d(voxel_of(m_body.elements, slot)) - at).length());
    });
    const auto found = nearest_slot(m_body.elements, at);
    if (found) {
      EXPECT_NEAR((Vec3d(voxel_of(m_body.elements, *found)) - at).length(), least, 1e-12) << at;
    } else {
      EXPECT_GT(least, 3.5) << at;
    }
  }
}
