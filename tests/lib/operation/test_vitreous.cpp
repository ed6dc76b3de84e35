#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "lib/chainmail/ecm.h"
#include "lib/instruments/round_cone.h"
#include "lib/operation/one_sided_push.h"
#include "lib/operation/vitreous.h"
#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/base/units.h"

namespace supple {
namespace {

const Vec3d kCentre(1, -2, 3);

VitreousSetup small_setup() {
  VitreousSetup setup;
  setup.radius_mm = 5;
  setup.clears_mm = 0;
  setup.spacing_mm = 0.4;
  return setup;
}

/// A straight tool with a port in its side.
Instrument make_tool(double radius_mm) {
  Instrument tool;
  tool.name = "tool";
  tool.kind = InstrumentKind::vitrector;
  tool.parts = {{{Vec3d(0, 0, radius_mm), Vec3d(0, 0, 30), radius_mm, radius_mm}, 0}};
  tool.port = SuctionPort{Vec3d(0, radius_mm, 1), Vec3d(0, 1, 0), 0.2, 1.0};
  return tool;
}

InstrumentPose pose_at(const Vec3d& tip_mm, const Vec3d& axis = {0, 0, 1}, double active = 0) {
  InstrumentPose pose;
  pose.tip_mm = tip_mm;
  pose.axis = axis.normalized();
  pose.active = active;
  return pose;
}

ToolMotion motion_between(const Instrument& tool, const InstrumentPose& from,
                          const InstrumentPose& to) {
  ToolMotion motion{0, from, to, {}};
  const auto placed = [](const RoundCone& local, const InstrumentPose& pose) {
    const ToolFrame frame = frame_of(pose);
    return RoundCone{frame.place(local.a_mm), frame.place(local.b_mm), local.a_radius_mm,
                     local.b_radius_mm};
  };
  for (const InstrumentPart& part : tool.parts) {
    motion.parts.push_back({placed(part.shape, from), placed(part.shape, to)});
  }
  return motion;
}

Vec3d place_of(const Vitreous& vitreous, Slot slot) {
  const Body& body = vitreous.body();
  Vec3d index(voxel_of(body.elements, slot));
  for (int c = 0; c < 3; ++c) index[c] += body.q[std::size_t(c)].at(slot) / kFixedOne;
  return body.geometry.world_from_index(index);
}

double deepest_in(const Vitreous& vitreous, const ToolMotion& motion) {
  double deepest = 0;
  for_each_element(vitreous.body().elements, [&](Slot slot) {
    if (!vitreous.is_left(slot)) return;
    for (const MovingPart& part : motion.parts) {
      const double distance = approach(place_of(vitreous, slot), part.to).distance_mm;
      deepest = std::max(deepest, -distance);
    }
  });
  return deepest;
}

/// A way of a tool's tip that wanders through the middle of the ball.
class Wandering {
 public:
  explicit Wandering(unsigned seed) : m_random(seed) {}
  InstrumentPose next(double step_mm, double active = 0) {
    std::uniform_real_distribution<double> part(-1, 1);
    const auto any = [&] { return Vec3d(part(m_random), part(m_random), part(m_random)); };
    m_tip += any() * step_mm - m_tip * 0.05;
    m_axis = (m_axis * 10.0 + any()).normalized();
    return pose_at(kCentre + m_tip, m_axis, active);
  }

 private:
  std::mt19937 m_random;
  Vec3d m_tip{0, 0, 0}, m_axis{0, 0, 1};
};

TEST(UnitVitreous, AtRestItIsABallOfVoxelsAboutItsCentre) {
  const VitreousSetup setup = small_setup();
  const Vitreous vitreous(setup, kCentre, 1);
  const double expected = 4 * kPi / 3 * std::pow(setup.radius_mm / setup.spacing_mm, 3);
  EXPECT_NEAR(double(vitreous.body().elements.active_count()), expected, 0.02 * expected);
  EXPECT_EQ(vitreous.left_part(), 1);
  Vec3d sum(0);
  double farthest = 0;
  for_each_element(vitreous.body().elements, [&](Slot slot) {
    sum += place_of(vitreous, slot) - kCentre;
    farthest = std::max(farthest, (place_of(vitreous, slot) - kCentre).length());
  });
  EXPECT_LT((sum / expected).length(), 1e-9);
  EXPECT_LE(farthest, setup.radius_mm + 1e-9);
}

TEST(UnitVitreous, DensitiesFollowFromTheSeed) {
  const auto sum = [](const Vitreous& vitreous) {
    double total = 0;
    for_each_voxel(vitreous.density().bricks(),
                   [&](const Vec3i& v) { total += double(vitreous.density().at(v)) * (v.x + 1); });
    return total;
  };
  const Vitreous a(small_setup(), kCentre, 1), b(small_setup(), kCentre, 1),
      c(small_setup(), kCentre, 2);
  EXPECT_EQ(sum(a), sum(b));
  EXPECT_NE(sum(a), sum(c));
}

TEST(FaultVitreous, ASetupWithoutABodyIsRefused) {
  for (const auto& [radius, spacing, clears] :
       {std::array<double, 3>{0, 0.4, 0}, {5, 0, 0}, {5, 0.4, 5}, {5, 0.4, -1}, {500, 0.4, 0}}) {
    VitreousSetup setup;
    setup.radius_mm = radius;
    setup.spacing_mm = spacing;
    setup.clears_mm = clears;
    EXPECT_THROW(Vitreous(setup, kCentre, 1), InputError) << radius << " " << spacing;
  }
}

TEST(PropertyVitreous, NoLinkIsBeyondItsLimitsAndTheShellStays) {
  for (const double radius : {0.25, 0.8}) {
    Vitreous vitreous(small_setup(), kCentre, 1);
    const std::vector<Instrument> tools{make_tool(radius)};
    Wandering way(3);
    InstrumentPose pose = way.next(0.5);
    std::int64_t moved = 0;
    for (int n = 0; n < 40; ++n) {
      const InstrumentPose next = way.next(0.8, n > 20 ? 1 : 0);
      moved += vitreous.step({motion_between(tools[0], pose, next)}, tools).moved;
      pose = next;
      ASSERT_EQ(check_links(vitreous.body()).violated, 0) << radius << " step " << n;
    }
    EXPECT_GT(moved, 500);
    const BrickTopology& elements = vitreous.body().elements;
    for_each_element(elements, [&](Slot slot) {
      Slot other;
      int links = 0;
      for (int side = 0; side < 6; ++side) {
        links += neighbour_slot(elements, {}, slot, side / 2, side % 2 == 1, other);
      }
      if (links == 6) return;
      for (const BrickValues& coordinate : vitreous.body().q) {
        ASSERT_EQ(coordinate.at(slot), 0) << voxel_text(voxel_of(elements, slot));
      }
    });
  }
}

TEST(PropertyVitreous, WhatIsLeftInAToolIsToldAndAThinOneHoldsNoneDeeperThanAVoxel) {
  for (const double radius : {0.25, 1.5}) {
    Vitreous vitreous(small_setup(), kCentre, 1);
    const std::vector<Instrument> tools{make_tool(radius)};
    Wandering way(5);
    InstrumentPose pose = way.next(0.5);
    bool any_stopped = false;
    for (int n = 0; n < 40; ++n) {
      const InstrumentPose next = way.next(0.4);
      const ToolMotion motion = motion_between(tools[0], pose, next);
      const VitreousReport report = vitreous.step({motion}, tools);
      const double deepest = deepest_in(vitreous, motion);
      EXPECT_EQ(report.stopped, deepest > small_setup().spacing_mm) << n;
      EXPECT_LE(deepest, std::max(report.deepest_mm, 0.1201) + 1e-9) << n;
      if (radius < 0.3) {
        EXPECT_FALSE(report.stopped) << n << " " << deepest;
      }
      any_stopped |= report.stopped;
      pose = next;
    }
    EXPECT_EQ(any_stopped, radius > 1);
  }
}

TEST(PropertyVitreous, WhatIsNotTouchedDoesNotMove) {
  Vitreous vitreous(small_setup(), kCentre, 1);
  const std::vector<Instrument> tools{make_tool(0.5)};
  const std::string before = vitreous.state_bytes();
  const InstrumentPose away = pose_at(kCentre + Vec3d(6, 0, 0)),
                       farther = pose_at(kCentre + Vec3d(7, 3, 0));
  const VitreousReport outside = vitreous.step({motion_between(tools[0], away, farther)}, tools);
  EXPECT_EQ(outside.moved, 0);
  EXPECT_EQ(vitreous.state_bytes(), before);

  const InstrumentPose in = pose_at(kCentre + Vec3d(0.1, 0.1, 2));
  const VitreousReport report = vitreous.step({motion_between(tools[0], in, in)}, tools);
  EXPECT_GT(report.moved, 0);
  std::int64_t changed = 0, listed = 0;
  for_each_element(vitreous.body().elements, [&](Slot slot) {
    const bool is_moved = vitreous.body().q[0].at(slot) != 0 ||
                          vitreous.body().q[1].at(slot) != 0 || vitreous.body().q[2].at(slot) != 0;
    changed += is_moved;
  });
  for (const SlotSet::Brick& brick : vitreous.moved()) listed += mask_count(brick.mask);
  EXPECT_EQ(report.moved, changed);
  EXPECT_EQ(listed, changed);
  EXPECT_LT(changed, vitreous.body().elements.active_count() / 4);
}

TEST(PropertyVitreous, AnActivePortRemovesWhatItReachesAndNothingElse) {
  Vitreous vitreous(small_setup(), kCentre, 1);
  const std::vector<Instrument> tools{make_tool(0.25)};
  const InstrumentPose idle = pose_at(kCentre + Vec3d(0.13, 0, 0));
  EXPECT_EQ(vitreous.step({motion_between(tools[0], idle, idle)}, tools).removed, 0);
  InstrumentPose sucks = idle;
  sucks.active = 1;
  std::vector<Slot> expected;
  const ToolFrame frame = frame_of(sucks);
  const SuctionPort port = *tools[0].port;
  for_each_element(vitreous.body().elements, [&](Slot slot) {
    const Vec3d from = place_of(vitreous, slot) - frame.place(port.centre_mm);
    const bool is_before = from.dot(frame.direction(port.outward)) >= 0;
    if (is_before && from.length() <= port.reach_mm) expected.push_back(slot);
  });
  const double count = double(vitreous.body().elements.active_count());
  const VitreousReport report = vitreous.step({motion_between(tools[0], sucks, sucks)}, tools);
  EXPECT_EQ(vitreous.removed(), expected);
  EXPECT_EQ(report.removed, std::int64_t(expected.size()));
  EXPECT_GT(report.removed, 10);
  EXPECT_EQ(vitreous.left_part(), 1 - double(expected.size()) / count);
  for (const Slot slot : expected) {
    EXPECT_FALSE(vitreous.is_left(slot));
    const Vec3i voxel = voxel_of(vitreous.body().elements, slot);
    EXPECT_FALSE(vitreous.density().bricks().is_active(voxel));
    Slot other;
    for (int side = 0; side < 6; ++side) {
      EXPECT_FALSE(neighbour_slot(vitreous.body().elements, vitreous.body().cuts, slot, side / 2,
                                  side % 2 == 1, other));
    }
  }
  EXPECT_EQ(vitreous.density().bricks().active_count(),
            vitreous.body().elements.active_count() - report.removed);
}

TEST(PropertyVitreous, RemovalOnlyShrinksIt) {
  Vitreous vitreous(small_setup(), kCentre, 1);
  const std::vector<Instrument> tools{make_tool(0.25)};
  Wandering way(7);
  InstrumentPose pose = way.next(0.5);
  double left = 1;
  for (int n = 0; n < 30; ++n) {
    const InstrumentPose next = way.next(0.8, 1);
    vitreous.step({motion_between(tools[0], pose, next)}, tools);
    EXPECT_LE(vitreous.left_part(), left);
    left = vitreous.left_part();
    pose = next;
  }
  EXPECT_LT(left, 0.97);
}

TEST(PropertyVitreous, BitsDoNotDependOnTheNumberOfThreads) {
  const auto bytes_with = [](int threads) {
    const ThreadLimit limit(threads);
    Vitreous vitreous(small_setup(), kCentre, 1);
    const std::vector<Instrument> tools{make_tool(0.3)};
    Wandering way(9);
    InstrumentPose pose = way.next(0.5);
    for (int n = 0; n < 20; ++n) {
      const InstrumentPose next = way.next(0.6, n % 2);
      vitreous.step({motion_between(tools[0], pose, next)}, tools);
      pose = next;
    }
    return vitreous.state_bytes();
  };
  EXPECT_EQ(bytes_with(1), bytes_with(2));
}

/// A cube of voxels whose outer layer is held.
struct HeldCube {
  static constexpr int kDim = 15;
  HeldCube() {
    std::vector<float> values(8 * kBrickVoxels, 1);
    std::vector<Vec3i> origins;
    std::vector<BrickMask> masks;
    for (int n = 0; n < 8; ++n) {
      origins.emplace_back(8 * (n / 4), 8 * (n / 2 % 2), 8 * (n % 2));
      BrickMask mask{};
      for (int i = 0; i < kBrickVoxels; ++i) {
        const Vec3i v = origins.back() + brick_local(i);
        if (std::max({v.x, v.y, v.z}) < kDim) mask_set(mask, i);
      }
      masks.push_back(mask);
    }
    const BrickTopology elements(origins, masks);
    const Geometry geometry(Vec3i(kDim), Vec3d(0),
                            {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)});
    body = make_body(geometry, make_density_grid(elements, values, 0), elements,
                     homogeneous_material(0, 255));
    for (int c = 0; c < 3; ++c) {
      for (const int side : {0, kDim - 1}) {
        Vec3i lo(0), hi(kDim - 1);
        lo[c] = hi[c] = side;
        anchors.emplace_back(lo, hi);
      }
    }
    for (const Region& region : anchors) fixed.add(elements_of(body, region, "fix"));
  }
  Slot slot(const Vec3i& voxel) const {
    Slot found = 0;
    EXPECT_TRUE(slot_of(body.elements, voxel, found));
    return found;
  }
  Body body;
  std::vector<Region> anchors;
  SlotSet fixed;
};

TEST(PropertyOneSidedPush, AsksThatAgreeGiveWhatPushHandlesGive) {
  HeldCube pushed, dragged;
  OneSidedPush push(pushed.body, pushed.fixed);
  EcmSolver solver(dragged.body);
  const Vec3i a(5, 7, 7), b(9, 6, 8);
  const std::array<std::int32_t, 3> by_a{40000, -30000, 20000}, by_b{50000, 10000, -15000};
  OneSidedAsks asks;
  for (const auto& [voxel, by] : {std::pair(a, by_a), std::pair(b, by_b)}) {
    for (std::size_t c = 0; c < 3; ++c) {
      (by[c] > 0 ? asks.at_least : asks.at_most)[c].push_back({pushed.slot(voxel), by[c]});
    }
  }
  push.push(asks);
  const EcmReport report = solver.drag(
      {Handle(a, by_a, HandleKind::push), Handle(b, by_b, HandleKind::push)}, dragged.anchors);
  ASSERT_EQ(report.fraction(), 1);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(pushed.body.q[c], dragged.body.q[c]) << c;
  std::int64_t moved = 0;
  for (const SlotSet::Brick& brick : push.changes()) moved += mask_count(brick.mask);
  EXPECT_EQ(moved, report.moved);
}

TEST(PropertyOneSidedPush, AsksThatContradictEachOtherShareWhatIsMissing) {
  HeldCube cube;
  OneSidedPush push(cube.body, cube.fixed);
  const Slot low = cube.slot({7, 7, 7}), high = cube.slot({8, 7, 7});
  OneSidedAsks asks;
  asks.at_most[0] = {{low, -40000}};
  asks.at_least[0] = {{high, 40000}};
  push.push(asks);
  const std::int32_t limit = fixed_slack(0.2);  // stretch of 1.2
  EXPECT_NEAR(cube.body.q[0].at(low), -limit / 2.0, 1);
  EXPECT_NEAR(cube.body.q[0].at(high), limit / 2.0, 1);
  EXPECT_EQ(check_links(cube.body).violated, 0);
}

TEST(PropertyOneSidedPush, AnchorsShortenAsksAndStay) {
  HeldCube cube;
  OneSidedPush push(cube.body, cube.fixed);
  OneSidedAsks asks;
  asks.at_least[1] = {{cube.slot({7, 12, 7}), 10 * 65536}};
  push.push(asks);
  // Two links of at least 0.8 to the wall.
  EXPECT_EQ(cube.body.q[1].at(cube.slot({7, 12, 7})), 2 * fixed_slack(0.2));
  cube.fixed.for_each([&](Slot slot) { ASSERT_EQ(cube.body.q[1].at(slot), 0); });
  EXPECT_EQ(check_links(cube.body).violated, 0);
}

}  // namespace
}  // namespace supple
