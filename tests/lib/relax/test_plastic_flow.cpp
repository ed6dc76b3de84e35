// Plastic flow: what a body keeps when it is let go.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/chainmail/ecm.h"
#include "lib/model/relax_model.h"
#include "tests/lib/relaxed_bodies.h"
#include "tests/lib/test_bodies.h"

using namespace supple;
using namespace supple::test;

namespace {

MaterialTable yielding_table(double yield) {
  MaterialTable table = constant_table(3, 0.1, 2);
  table.yield_strain = Curve{{{0, yield}}};
  return table;
}

/// Pulls the far end of a bar along i by so many voxels, relaxes, lets go, relaxes again; returns
/// how far the end is from where it was.
double set_of_bar(Body& body, int length, double by) {
  const IndexBox& bounds = body.elements.active_bounds();
  const Region near({0, bounds.lo.y, bounds.lo.z}, {0, bounds.hi.y, bounds.hi.z});
  const Region far({length - 1, bounds.lo.y, bounds.lo.z}, {length - 1, bounds.hi.y, bounds.hi.z});
  Holds holds;
  drag(body, {{far, {std::int32_t(by * kVoxel), 0, 0}}}, {near}, holds);
  relax(body, {near}, holds, to_rest());
  relax(body, {near}, {}, to_rest());
  return body.offset({length - 1, bounds.lo.y, bounds.lo.z}, 0) / kFixedOne;
}

}  // namespace

TEST(PropertyPlasticFlow, AChainKeepsWhatExceedsItsElasticStretch) {
  for (const double by : {-3.0, 0.5, 1.9, 2.5, 6.0}) {
    Body body =
        body_of(full_block({21, 1, 1}, yielding_table(0.1), [](int, int, int) { return 9.0; }));
    // 20 links, elastic up to 0.1 voxel each.
    const double expected = std::abs(by) <= 2 ? 0 : by - std::copysign(2.0, by);
    EXPECT_NEAR(set_of_bar(body, 21, by), expected, 1e-3) << by;
  }
}

TEST(PropertyPlasticFlow, ABarUnderTensionKeepsWhatExceedsItsElasticStretch) {
  Body body =
      body_of(full_block({13, 4, 3}, yielding_table(0.05), [](int, int, int) { return 9.0; }));
  EXPECT_NEAR(set_of_bar(body, 13, 1.8), 1.8 - 12 * 0.05, 2e-3);
  EXPECT_EQ(check_links(body).violated, 0);
}

TEST(PropertyPlasticFlow, TheEnergyIsWhatIsStoredAndWhatTheFlowTakes) {
  Body body =
      body_of(full_block({21, 1, 1}, yielding_table(0.1), [](int, int, int) { return 9.0; }));
  const Region near({0, 0, 0});
  Holds holds;
  drag(body, {{{20, 0, 0}, {6 * kVoxel, 0, 0}}}, {near}, holds);
  // 1 N/m each; beyond 0.1 mm a link takes 0.1 mN for every further millimetre.
  const RelaxReport report = relax(body, {near}, holds, to_rest());
  EXPECT_NEAR(report.energy_after, 0.1 * 6 - 20 * 0.1 * 0.1 / 2, 1e-4);
}

TEST(PropertyPlasticFlow, TheSetGrowsOnlyBeyondTheLargestLoadSoFar) {
  Body body =
      body_of(full_block({21, 1, 1}, yielding_table(0.1), [](int, int, int) { return 9.0; }));
  EXPECT_NEAR(set_of_bar(body, 21, 4), 2, 1e-3);
  const RestStretch after_first = body.rest;
  // To 3.9 and back: all elastic around the new rest shape.
  EXPECT_NEAR(set_of_bar(body, 21, 1.9), 2, 1e-3);
  EXPECT_EQ(body.rest[0][0], after_first[0][0]);
  EXPECT_NEAR(set_of_bar(body, 21, 3), 3, 1e-3);
}

TEST(PropertyPlasticFlow, AcrossALinkTheYieldIsAFractionOfItsLength) {
  Block block = full_block({2, 1, 1}, yielding_table(0.25), [](int, int, int) { return 9.0; });
  block.spacing_mm = {4, 0.5, 1};
  Body body = body_of(block);
  const Region first({0, 0, 0});
  Holds holds;
  // 0.25 of 4 mm are 2 voxels of 0.5 mm; dragged by 6, 4 are kept.
  drag(body, {{{1, 0, 0}, {0, 6 * kVoxel, 0}}}, {first}, holds);
  relax(body, {first}, holds, to_rest());
  relax(body, {first}, {}, to_rest());
  EXPECT_NEAR(body.offset({1, 0, 0}, 1) / kFixedOne, 4, 1e-3);
}

TEST(PropertyPlasticFlow, AnElasticBodyHasNoMemoryForIt) {
  Body body = body_of(soft_block({12, 3, 3}));
  set_of_bar(body, 12, 3);
  for (const auto& axis : body.rest) {
    for (const BrickValues& coordinate : axis) EXPECT_EQ(coordinate.brick_count(), 0u);
  }
}
