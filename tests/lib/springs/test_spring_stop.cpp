// Long steps of springs stop when the user asks, and leave the last finished step.
#include <gtest/gtest.h>

#include "lib/model/spring_models.h"
#include "lib/springs/integrators.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Asks to stop after so many looks.
class StopAfterLooks final : public Progress {
 public:
  explicit StopAfterLooks(int looks) : m_left(looks) {}
  void stage(std::string_view) override {}
  void update(double) override {}
  bool cancelled() const override { return --m_left < 0; }
  int left() const { return m_left; }

 private:
  mutable int m_left;
};

/// 14^3 voxels, too many for factors, on a held layer and under their weight.
struct HeavyCube {
  HeavyCube() {
    params.gravity_m_s2 = {0, 0, -9.81};
    params.step_s = 0.005;
  }
  HeldBody held() { return {body, anchors, holds}; }

  Body body = body_of(soft_block({14, 14, 14}));
  std::vector<Region> anchors = {Region(IndexBox{{0, 0, 0}, {13, 13, 0}})};
  Holds holds;
  MotionParams params;
};

}  // namespace

TEST(FaultSpringStop, EveryModelLooksManyTimesWithinOneStepAndStopsAtAnyOfThem) {
  for (int kind = 0; kind < 5; ++kind) {
    HeavyCube cube;
    cube.params.minimise = kind == 4;
    cube.params.method = SpringMethod(kind % 4);
    const LatticeSpringParams springs = material_springs(cube.body);
    StopAfterLooks never(1000000);
    VoxelSpringModel(cube.held(), springs, cube.params).step(&never);
    const int looks = 1000000 - never.left();
    EXPECT_GT(looks, 10) << kind;
    std::vector<int> stops = {0, 1, looks / 2, looks - 1};
    if (kSanitized) stops = {looks / 2};
    for (const int stop : stops) {
      VoxelSpringModel model(cube.held(), springs, cube.params);
      const std::vector<Vec3d> pos = model.system().pos_mm;
      StopAfterLooks soon(stop);
      EXPECT_THROW(model.step(&soon), Cancelled) << kind << " after " << stop;
      EXPECT_EQ(model.system().pos_mm, pos) << kind << " after " << stop;
    }
  }
}
