// Tools led along sampled bone, whose normals jump from voxel to voxel.
#include <gtest/gtest.h>

#include "tests/lib/instruments/tool_cases.h"

namespace supple::test {
namespace {

/// Bone of 30 · 30 columns of two voxels of 1 mm at random heights.
VoxelSolid ragged_bone(std::mt19937& random) {
  std::vector<Vec3i> voxels;
  for (int i = 0; i < 30; ++i) {
    for (int j = 0; j < 30; ++j) {
      const int low = int(random_number(random, 0, 4));
      for (int k = low; k < low + 2; ++k) voxels.push_back({i, j, k});
    }
  }
  return VoxelSolid(
      Geometry({30, 30, 8}, Vec3d(0.0), {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)}), voxels);
}

InstrumentPose pose_above(std::mt19937& random) {
  InstrumentPose pose;
  pose.tip_mm = {random_number(random, 10, 20), random_number(random, 10, 20), 14};
  pose.axis = {random_number(random, -1, 1), random_number(random, -1, 1), 0.5};
  pose.axis.normalize();
  return pose;
}

}  // namespace

TEST(PropertySampledContact, BoneThatStopsAToolTouchesItAndLeadsItNoFartherFromTheHand) {
  std::mt19937 random(7);
  const Instrument tool = instrument_of(InstrumentKind::spatula);
  int stops = 0;
  for (int n = 0; n < 40; ++n) {
    const std::vector<Obstacle> bone = {{"bone", ragged_bone(random)}};
    InstrumentPose pose = pose_above(random), asked = pose;
    for (int step = 0; step < 25; ++step) {
      asked.tip_mm.z -= 0.8;
      const double before_mm = (asked.tip_mm - pose.tip_mm).length();
      const StoppedTool led = lead(tool, pose, asked, bone, nullptr);
      pose = led.pose;
      const double left_mm = (asked.tip_mm - pose.tip_mm).length();
      if (left_mm < 1e-3) continue;
      ++stops;
      EXPECT_FALSE(led.touches.empty()) << n << ", " << step;
      EXPECT_LE(left_mm, before_mm + 1e-6) << n << ", " << step;
    }
  }
  EXPECT_GT(stops, 400);
}

}  // namespace supple::test
