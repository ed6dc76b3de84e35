#include <gtest/gtest.h>

#include "lib/body/body.h"
#include "tests/lib/brute_force.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Three soft voxels in a row along i, across a brick border.
Body row_of_three() {
  Block block = full_block({3, 1, 1}, linear_table(1.5, 0.6, 0.7),
                           [](int i, int, int) { return i == 0 ? 0.0 : 255.0; });
  block.origin = {6, 0, 0};
  return body_of(block);
}

}  // namespace

TEST(UnitBody, ClassesComeFromTheDensitiesOfTheElements) {
  const Body body = row_of_three();
  EXPECT_EQ(body.elements.active_count(), 3);
  EXPECT_EQ(body.classes[std::size_t(brick_offset({6, 0, 0}))], 0);
  EXPECT_EQ(body.classes[std::size_t(brick_offset({7, 0, 0}))], 255);
  EXPECT_EQ(body.classes[kBrickVoxels], 255);
  EXPECT_EQ(body.offset({7, 0, 0}, 0), 0);
}

TEST(UnitBody, LinksAreCheckedAcrossBricksWithTheirExcess) {
  Body body = row_of_three();
  EXPECT_EQ(check_links(body).links, 2);
  EXPECT_EQ(check_links(body).violated, 0);
  // Voxel 8 pulled 0.75 voxel from voxel 7, where 0.5 is allowed; both coordinates of it count
  // once.
  body.q[0].resize(2);
  body.q[0].set(kBrickVoxels, 49152);
  body.q[1].resize(2);
  body.q[1].set(kBrickVoxels, 49152);
  const LinkCheck check = check_links(body);
  EXPECT_EQ(check.violated, 1);
  EXPECT_DOUBLE_EQ(check.worst_excess_voxels, 0.25);
  // Pushed 0.5 voxel towards it, where floor(0.4 * 65536) units are allowed.
  body.q[1].clear();
  body.q[0].set(kBrickVoxels, -32768);
  EXPECT_DOUBLE_EQ(check_links(body).worst_excess_voxels, (32768 - 26214) / 65536.0);
}

TEST(UnitBody, FoldFreeNeedsMinLengthAboveTwiceTheShearAndInOneSliceAboveTheShear) {
  const auto fold_free = [](const Vec3i& dims, double shear) {
    return check_links(body_of(full_block(dims, linear_table(1.5, 0.6, shear),
                                          [](int, int, int) { return 255.0; })))
        .fold_free;
  };
  EXPECT_TRUE(fold_free({3, 3, 3}, 0.29));
  EXPECT_FALSE(fold_free({3, 3, 3}, 0.31));
  EXPECT_TRUE(fold_free({3, 3, 1}, 0.59));
  EXPECT_TRUE(fold_free({1, 3, 3}, 0.59));
  EXPECT_FALSE(fold_free({3, 3, 1}, 0.61));
  EXPECT_TRUE(fold_free({9, 1, 1}, 5));
}

TEST(UnitBody, OneSoftLinkIsEnoughToLoseTheFoldGuarantee) {
  Block block =
      full_block({4, 4, 4}, linear_table(1.5, 0.6, 0.7), [](int, int, int) { return 0.0; });
  EXPECT_TRUE(check_links(body_of(block)).fold_free);
  block.density[block.index(1, 1, 1)] = block.density[block.index(2, 1, 1)] = 255;
  EXPECT_FALSE(check_links(body_of(block)).fold_free);
}

TEST(UnitBody, ACutLosesTheFoldGuaranteeAndItsLinksAreNotChecked) {
  Body body = row_of_three();
  EXPECT_TRUE(check_links(body).fold_free);
  body.cuts.cut(0, brick_offset({7, 0, 0}), 0);
  for (auto& q : body.q) q.resize(body.elements.brick_count());
  body.q[0].set(kBrickVoxels, 99 << 16);
  const LinkCheck check = check_links(body);
  EXPECT_EQ(check.links, 1);
  EXPECT_EQ(check.violated, 0);
  EXPECT_FALSE(check.fold_free);
}

TEST(PropertyBody, TheNearestElementIsTheNearest) {
  std::mt19937 random(5);
  for (int n = 0; n < cases(100); ++n) {
    const Block block = random_block(random, {20, 20, 6});
    const Body body = body_of(block);
    const Vec3i from(int(random() % 60) - 30, int(random() % 60) - 30, int(random() % 60) - 30);
    const auto square = [&](const Vec3i& v) { return (v - from).dot(v - from); };
    int best = INT32_MAX;
    for (int e = 0; e < block.size(); ++e) {
      if (block.element[e]) best = std::min(best, square(block.voxel(e)));
    }
    Vec3i nearest;
    ASSERT_TRUE(nearest_element(body, from, nearest));
    EXPECT_TRUE(body.elements.is_active(nearest));
    EXPECT_EQ(square(nearest), best);
  }
  Vec3i nearest;
  EXPECT_FALSE(nearest_element(Body{}, {0, 0, 0}, nearest));
}

TEST(UnitBody, AStateContinuesWithItsOffsetsAndIsNotTrustedToBeValid) {
  const Body rest = row_of_three();
  State state;
  state.geometry = rest.geometry;
  state.density = make_density_grid(rest.elements, std::vector<float>(rest.classes.size(), 255), 0);
  state.elements = rest.elements;
  EXPECT_TRUE(make_body(state, rest.material).links_known_valid);
  state.q[2].resize(2);
  state.q[2].set(kBrickVoxels, 65536);
  const Body body = make_body(state, rest.material);
  EXPECT_FALSE(body.links_known_valid);
  EXPECT_EQ(body.offset({8, 0, 0}, 2), 65536);
  EXPECT_EQ(body.offset({8, 0, 0}, 0), 0);
}
