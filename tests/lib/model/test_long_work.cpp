// Work that takes long tells how far it is, and looks for a wish to stop within every stage.
#include <algorithm>
#include <ctime>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "lib/model/fem_model.h"
#include "lib/model/spring_models.h"
#include "tests/lib/fem_fixtures.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Processor time between two looks, and what is told in between.
class Listener final : public Progress {
 public:
  void stage(std::string_view name) override {
    m_stage = name;
    m_told = 0;
  }
  void update(double fraction) override {
    EXPECT_GE(fraction, m_told) << m_stage;
    EXPECT_LE(fraction, 1) << m_stage;
    m_told = fraction;
    ++updates;
    ++updates_in[m_stage];
  }
  bool cancelled() const override {
    const std::clock_t now = std::clock();
    if (now - m_last > longest) {
      longest = now - m_last;
      longest_in = m_stage;
    }
    m_last = now;
    return false;
  }
  double told() const { return m_told; }

  int updates = 0;
  std::map<std::string, int> updates_in;
  mutable std::clock_t longest = 0;
  mutable std::string longest_in;

 private:
  std::string m_stage;
  double m_told = 0;
  mutable std::clock_t m_last = std::clock();
};

/// No stretch between two looks is a third of the whole.
void expect_looks(const Listener& listener, std::clock_t start) {
  const double whole = double(std::clock() - start);
  EXPECT_LT(double(listener.longest), whole / 3) << listener.longest_in;
}

/// Asks to stop at one of the looks.
class StopAt final : public Progress {
 public:
  explicit StopAt(int look) : m_left(look) {}
  void stage(std::string_view) override {}
  void update(double) override {}
  bool cancelled() const override { return m_left-- <= 0; }
  int left() const { return m_left; }

 private:
  mutable int m_left;
};

struct HeldCube {
  explicit HeldCube(int n)
      : body(fem_cube(n)),
        anchors{Region(IndexBox{{0, 0, 0}, {n - 1, n - 1, 0}})},
        handles{{IndexBox{{n / 2, n / 2, n - 1}, {n / 2, n / 2, n - 1}}, {1 << 15, 0, 1 << 14}}} {}
  HeldBody held() { return {body, anchors, holds}; }

  Body body;
  std::vector<Region> anchors;
  Holds holds;
  std::vector<Handle> handles;
};

}  // namespace

TEST(PropertyLongWork, FiniteElementsTellEveryIterationAndLookWithinEveryStage) {
  LEFT_OUT_WHEN_SANITIZED();
  HeldCube cube(40);
  Listener listener;
  const std::clock_t start = std::clock();
  VoxelFemModel model(cube.held(), ElasticTable::uniform(5, 0.45), {}, {}, nullptr, 0, &listener);
  model.move(cube.handles, 1, &listener);
  expect_looks(listener, start);
  EXPECT_GE(listener.updates, model.report().iterations);
  EXPECT_GT(listener.told(), 0.9);
  EXPECT_GT(listener.updates_in["making meshes"], 20);
}

TEST(PropertyLongWork, FiniteElementsStopAtAnyLookAndLeaveTheBodyAsItWas) {
  const auto solve = [](HeldCube& cube, Progress* progress) {
    VoxelFemModel model(cube.held(), ElasticTable::uniform(5, 0.3), {}, {}, nullptr, 0, progress);
    model.move(cube.handles, 1, progress);
    model.store();
  };
  HeldCube whole(12);
  StopAt never(1 << 20);
  solve(whole, &never);
  const int looks = (1 << 20) - never.left();
  EXPECT_GT(looks, 40);
  for (int part = 0; part < 16; ++part) {
    HeldCube cube(12);
    const auto before = cube.body.q;
    StopAt soon(part * (looks - 1) / 15);
    EXPECT_THROW(solve(cube, &soon), Cancelled) << part;
    EXPECT_EQ(cube.body.q, before) << part;
    EXPECT_TRUE(cube.holds.anchored.empty()) << part;
  }
}

TEST(PropertyLongWork, SpringsLookWithinTheirFirstStep) {
  LEFT_OUT_WHEN_SANITIZED();
  Body body = body_of(soft_block({40, 40, 40}));
  const std::vector<Region> anchors = {Region(IndexBox{{0, 0, 0}, {39, 39, 0}})};
  Holds holds;
  MotionParams params;
  params.gravity_m_s2 = {0, 0, -9.81};
  params.step_s = 0.005;
  Listener listener;
  const std::clock_t start = std::clock();
  VoxelSpringModel model({body, anchors, holds}, material_springs(body), params, &listener);
  model.step(&listener);
  expect_looks(listener, start);
}
