// Distance of relaxation from the least energy that limits allow, found by another method.
#include <algorithm>

#include <gtest/gtest.h>

#include "lib/body/slot_set.h"
#include "lib/chainmail/ecm.h"
#include "lib/model/relax_model.h"
#include "tests/lib/quadratic_program.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Relative distances from the least energy, ascending.
std::vector<double> gaps_of(int count, int links) {
  std::mt19937 random(41);
  std::vector<double> gaps;
  for (int n = 0; n < count; ++n) {
    Block block = random_block(random, {9, 8, 6});
    block.table.links = links;
    Body body = body_of(block);
    Holds holds;
    for (int handle = 0; handle < 2; ++handle) {
      const Vec3i voxel = block.voxel(random_element(random, block));
      drag(body, {{voxel, {std::int32_t(random() % (4u * kVoxel)) - 2 * kVoxel, 0, 0}}}, {}, holds);
    }
    if (body.q[0].empty()) continue;
    double excess = 0;
    const double least = QuadraticProgram(body, 0, holds.anchored).minimise(1000, excess);
    if (excess > 1e-5 || least < 1e-2) continue;
    RelaxParams params;
    params.passes = 5000;
    params.tolerance_voxels = 1e-9;
    const double h = body.geometry.spacing_mm().x;
    const double found = relax(body, {}, holds, params).energy_after / (h * h);
    EXPECT_GE(found, least * (1 - 1e-3));
    gaps.push_back(found / least - 1);
  }
  std::sort(gaps.begin(), gaps.end());
  return gaps;
}

}  // namespace

TEST(PropertyRelaxation, ItComesNearTheLeastEnergyThatTheLimitsAllow) {
  LEFT_OUT_WHEN_SANITIZED();
  const std::vector<double> gaps = gaps_of(cases(40), 6);
  ASSERT_GE(gaps.size(), std::size_t(cases(20)));
  // All but a tenth; of the few under sanitizers every second.
  EXPECT_LE(gaps[gaps.size() * (kSanitized ? 5 : 9) / 10], 0.001);
  EXPECT_LE(gaps.back(), 0.05);
}

TEST(PropertyRelaxation, WithDiagonalsItComesNearTheLeastEnergyThatAllLimitsAllow) {
  LEFT_OUT_WHEN_SANITIZED();
  for (const int links : {18, 26}) {
    const std::vector<double> gaps = gaps_of(cases(14), links);
    ASSERT_GE(gaps.size(), std::size_t(cases(7)));
    EXPECT_LE(gaps[gaps.size() * (kSanitized ? 5 : 9) / 10], 0.005) << links;
    EXPECT_LE(gaps.back(), 0.05) << links;
  }
}
