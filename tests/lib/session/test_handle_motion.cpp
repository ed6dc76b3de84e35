// Turned and scaled handles against Eigen's rotations; handles with edges in a session.
#include <cmath>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "lib/material/material.h"
#include "lib/session/handles/drag_handles.h"
#include "lib/session/handles/handle_motion.h"
#include "lib/session/session.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/program.h"

using namespace supple;
using namespace supple::test;

namespace {

Eigen::Vector3d eigen(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

/// Sheared, left-handed now and then, of unequal spacings.
Geometry random_geometry(std::mt19937& random, const Vec3i& dims) {
  std::uniform_real_distribution<double> any(-1, 1), spacing(0.4, 2.5);
  std::array<Vec3d, 3> axes;
  for (int a = 0; a < 3; ++a) {
    axes[a] = Vec3d(0.3 * any(random), 0.3 * any(random), 0.3 * any(random));
    axes[a][a] += random() % 4 == 0 ? -1 : 1;
    axes[a] *= spacing(random);
  }
  return {dims, Vec3d(100 * any(random), 100 * any(random), 100 * any(random)), axes};
}

class UnitHandleEdges : public ::testing::Test {
 protected:
  UnitHandleEdges() {
    write_ball(m_folder, "ball", 24);
    write_soft_material(m_folder / "soft.toml");
    m_options.material = read_material(m_folder / "soft.toml");
  }

  Vec3d moved(const Session& session, const Vec3i& voxel) const {
    return Vec3d(session.body().offset(voxel, 0), session.body().offset(voxel, 1),
                 session.body().offset(voxel, 2)) /
           kFixedOne;
  }

  TemporaryFolder m_folder;
  SessionOptions m_options;
};

}  // namespace

TEST(PropertyHandleMotion, TargetsAreThoseOfAnAffineMapInMillimetresRoundedOnce) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int n = 0; n < 60; ++n) {
    Body body = body_of(homogeneous({9, 7, 5}, 1.3, 0.7, 0.3));
    body.geometry = random_geometry(random, {9, 7, 5});
    for (auto& q : body.q) {
      q.resize(body.elements.brick_count());
      for_each_active(body.elements.mask(0),
                      [&](int offset) { q.touch(0)[offset] = std::int32_t(70000 * any(random)); });
    }
    HandleMotion motion;
    motion.about_lps_mm = Vec3d(10 * any(random), 10 * any(random), 10 * any(random));
    motion.axis_lps = Vec3d(any(random), any(random), any(random));
    motion.angle_deg = n % 3 == 0 ? 0 : 180 * any(random);
    if (n % 2 == 0) motion.scale = {1 + 0.5 * any(random), 1 + 0.5 * any(random), 1.2};
    motion.scales_along_grid = n % 4 == 0;
    const Vec3d by_mm(3 * any(random), 3 * any(random), 3 * any(random));

    Eigen::Matrix3d axes, scale;
    for (int a = 0; a < 3; ++a) axes.col(a) = eigen(body.geometry.axes_mm()[a]);
    scale = eigen(motion.scale).asDiagonal();
    if (motion.scales_along_grid) scale = axes * scale * axes.inverse();
    const Eigen::Matrix3d linear =
        Eigen::AngleAxisd(motion.angle_deg * M_PI / 180, eigen(motion.axis_lps).normalized())
            .toRotationMatrix() *
        scale;
    Eigen::Vector3d shift(0, 0, 0);
    for (int a = 0; a < 3; ++a) shift += axes.col(a).normalized() * by_mm[a];

    const SlotSet slots = elements_of(body, Region({0, 0, 0}, {8, 6, 4}), "grab");
    const Displacements found = displacements_of(body, slots, motion, by_mm);
    ASSERT_EQ(found.size(), slots.size());
    std::size_t at = 0;
    slots.for_each([&](Slot slot) {
      Vec3d place(voxel_of(body.elements, slot));
      for (int c = 0; c < 3; ++c) place[c] += body.q[std::size_t(c)].at(slot) / kFixedOne;
      const Eigen::Vector3d from =
          eigen(body.geometry.origin_lps_mm()) + axes * eigen(place) - eigen(*motion.about_lps_mm);
      const Eigen::Vector3d way = axes.inverse() * (linear * from + shift - from) * kFixedOne;
      for (int c = 0; c < 3; ++c) {
        ASSERT_LE(std::abs(found[at][std::size_t(c)] - way[c]), 0.5 + 1e-4) << n;
      }
      ++at;
    });
  }
}

TEST_F(UnitHandleEdges, ATurnIsWhatTwoHalfTurnsComeToAndKeepsItsShape) {
  const auto turn = [&](double angle_deg, int times) {
    auto session = std::make_unique<Session>(m_folder / "ball.nhdr", m_options);
    Drag drag{Region({8, 8, 8}, {15, 15, 15}), {0, 0, 0}};
    drag.motion.about_lps_mm = Vec3d(11.5, 11.5, 17);
    drag.motion.axis_lps = {1, 2, -1};
    drag.motion.angle_deg = angle_deg;
    for (int n = 0; n < times; ++n) {
      Step request;
      request.drags.push_back(drag);
      EXPECT_EQ(session->step(request).report.fraction(), 1);
    }
    return session;
  };
  const auto once = turn(12, 1), twice = turn(6, 2);
  const Geometry& geometry = once->geometry();
  const auto place = [&](const Session& session, const Vec3i& voxel) {
    return geometry.world_from_index(Vec3d(voxel) + moved(session, voxel));
  };
  for (int k = 8; k <= 15; ++k) {
    for (int i = 8; i <= 15; ++i) {
      const Vec3i voxel(i, 11, k);
      EXPECT_LT((moved(*once, voxel) - moved(*twice, voxel)).length(), 4 / kFixedOne);
      const double rest =
          (geometry.world_from_index(Vec3d(voxel)) - geometry.world_from_index(Vec3d(8, 8, 8)))
              .length();
      EXPECT_NEAR((place(*once, voxel) - place(*once, {8, 8, 8})).length(), rest, 4e-5);
    }
  }
  EXPECT_GT(moved(*once, {8, 8, 8}).length(), 0.5);
}

TEST_F(UnitHandleEdges, AnEdgeGoesAtLeastItsPartAndStaysOutOfAnchors) {
  Session session(m_folder / "ball.nhdr", m_options);
  Selection ball;
  ball.ball_index = Vec3d(11.5, 11.5, 12);
  ball.radius_mm = 2.5;
  Step request;
  request.fix.push_back({{0, 0, 0}, {4, 23, 23}});
  Drag drag{Vec3i(0), {0, 1, 0}};
  drag.selection = ball;
  drag.soft_mm = 6;
  request.drags.push_back(drag);
  request.tells_reactions = true;
  const StepRecord record = session.step(request);
  EXPECT_EQ(record.report.fraction(), 1);
  EXPECT_EQ(record.reactions.size(), 1u);
  int in_edge = 0, anchored = 0;
  const Body& body = session.body();
  for_each_element(body.elements, [&](Slot slot) {
    const Vec3i voxel = voxel_of(body.elements, slot);
    const double beyond = (session.geometry().world_from_index(Vec3d(voxel)) -
                           session.geometry().world_from_index(*ball.ball_index))
                              .length() -
                          ball.radius_mm;
    const double went = moved(session, voxel).y;
    if (voxel.x <= 4) {
      EXPECT_EQ(went, 0);
      anchored += beyond > 0 && beyond < 6;
    } else if (beyond <= 0) {
      EXPECT_EQ(went, 1);
    } else if (beyond < 6) {
      const double t = beyond / 6;
      EXPECT_GE(went, (1 - t) * (1 - t) * (1 + 2 * t) - 1 / kFixedOne) << voxel;
      ++in_edge;
    }
  });
  EXPECT_GT(in_edge, 100);
  EXPECT_GT(anchored, 10);
}

TEST_F(UnitHandleEdges, AnchorsOfDensitiesAreKeptByTheStateAndReleased) {
  Session session(m_folder / "ball.nhdr", m_options);
  Selection shell;
  shell.density = NumberPair(1, 150);
  Step request;
  request.fix.emplace_back().selection = shell;
  request.drags.push_back({Vec3i(12, 12, 12), {30, 0, 0}});
  const double part = session.step(request).report.fraction();
  EXPECT_LT(part, 1);
  session.write_state(m_folder / "fixed.vdb");
  Session further(m_folder / "fixed.vdb");
  EXPECT_EQ(further.state().anchor_selections, session.state().anchor_selections);
  EXPECT_EQ(further.drag(Vec3i(12, 12, 12), {1, 0, 0}).report.fraction_numerator, 0);
  further.release();
  EXPECT_EQ(further.drag(Vec3i(12, 12, 12), {1, 0, 0}).report.fraction(), 1);
}
