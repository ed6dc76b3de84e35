#include <gtest/gtest.h>

#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/field/inversion/invert.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Moves the voxels of a ball; returns the bricks that were written.
std::vector<std::int32_t> change_ball(VectorBricks& u, const Vec3d& center, double radius,
                                      const std::function<Vec3f(const Vec3i&)>& value) {
  std::vector<std::int32_t> changed;
  for_each_slot(u.topology, [&](const Vec3i& v, std::size_t slot) {
    if ((Vec3d(v) - center).length() > radius) return;
    u.vectors.set(slot, value(v));
    const std::int32_t b = std::int32_t(slot / kBrickVoxels);
    if (changed.empty() || changed.back() != b) changed.push_back(b);
  });
  return changed;
}

}  // namespace

TEST(PropertyIncrementalInversion, AfterEveryLocalChangeItHasTheBitsOfAFullInversion) {
  std::mt19937 random(31);
  std::uniform_real_distribution<double> place(0, 32);
  Displacement displacement =
      displacement_on(box_topology({0, 0, 0}, {34, 36, 30}), [](const Vec3i&) { return Vec3f(0); });
  IncrementalInversion inversion(displacement);
  std::int64_t most_folds = 0;
  for (int step = 0; step < 12; ++step) {
    // Noise of growing size, far shifts that leave the box, and back to rest.
    const float size = step % 4 == 3 ? 0 : 0.1f * float(1 + step % 5);
    const Vec3f shift = step % 3 == 1 ? random_vector(random, 4) : Vec3f(0);
    const Vec3d center(place(random), place(random), place(random));
    const auto changed = change_ball(displacement.u, center, 3 + step % 6, [&](const Vec3i&) {
      return size == 0 ? Vec3f(0) : shift + random_vector(random, size);
    });
    inversion.update(displacement, changed);
    if (step % 4 == 2) continue;  // its residuals are measured with those of the next
    const OffsetField full = invert(displacement);
    expect_equal(inversion.field(displacement), full);
    most_folds = std::max(most_folds, full.certificate.folded_cells);
  }
  EXPECT_GT(most_folds, 0);
}

TEST(PropertyIncrementalInversion, OnlyOutputBricksInReachAreSolvedAgain) {
  Displacement displacement =
      displacement_on(box_topology(Vec3i(0), Vec3i(79)), [](const Vec3i&) { return Vec3f(0); });
  IncrementalInversion inversion(displacement);
  const auto changed = change_ball(displacement.u, Vec3d(36), 3,
                                   [](const Vec3i&) { return Vec3f(0.25f, 0.25f, 0.25f); });
  EXPECT_EQ(changed, std::vector<std::int32_t>{4 * 100 + 4 * 10 + 4});
  const std::vector<Vec3i> touched = inversion.update(displacement, changed);
  // Eight bricks have cells with a corner in the changed one; these reach one voxel further.
  EXPECT_EQ(touched.size(), 27u);
  EXPECT_EQ(touched.front(), Vec3i(24));
  EXPECT_EQ(touched.back(), Vec3i(40));
  const OffsetField full = invert(displacement);
  for (const Vec3i& origin : touched) {
    const VectorBrickView brick = inversion.finder()(origin);
    ASSERT_NE(brick.mask, nullptr);
    for_each_active(*brick.mask, [&](int n) {
      Vec3f o;
      ASSERT_TRUE(full.o.at(origin + brick_local(n), o));
      ASSERT_EQ(brick.vectors[n], o);
    });
  }
  EXPECT_TRUE(inversion.update(displacement, {}).empty());
}

TEST(PropertyIncrementalInversion, BricksThatMaterialLeavesHoldNothingAfterwards) {
  const BrickTopology where = box_topology(Vec3i(0), Vec3i(15));
  Displacement displacement = displacement_on(where, [](const Vec3i&) { return Vec3f(0); });
  IncrementalInversion inversion(displacement);
  const Displacement moved = displacement_on(where, [](const Vec3i&) { return Vec3f(64, 0, 0); });
  std::vector<std::int32_t> all;
  for (std::size_t b = 0; b < where.brick_count(); ++b) all.push_back(std::int32_t(b));
  const std::vector<Vec3i> touched = inversion.update(moved, all);
  EXPECT_NE(std::find(touched.begin(), touched.end(), Vec3i(0)), touched.end());
  EXPECT_EQ(inversion.finder()(Vec3i(0)).mask, nullptr);
  expect_equal(inversion.field(moved), invert(moved));
}

TEST(PropertyIncrementalInversion, TornMaterialIsSolvedAsAWhole) {
  const BrickTopology where = box_topology(Vec3i(0), Vec3i(23));
  Displacement displacement = displacement_on(where, [](const Vec3i&) { return Vec3f(0); });
  IncrementalInversion inversion(displacement);
  inversion.certificate(displacement);
  const auto changed =
      change_ball(displacement.u, Vec3d(12), 2, [](const Vec3i&) { return Vec3f(45, 5, 30); });
  inversion.update(displacement, changed);
  expect_equal(inversion.field(displacement), invert(displacement));
}

TEST(PropertyIncrementalInversion, DoesNotDependOnTheNumberOfThreads) {
  std::mt19937 random(32);
  Displacement displacement = noisy_displacement(random, box_topology(Vec3i(0), Vec3i(26)), 0.35f);
  const Displacement before = displacement;
  const auto changed = change_ball(displacement.u, Vec3d(13), 6,
                                   [&](const Vec3i&) { return random_vector(random, 0.35f); });
  for (const int threads : {1, 2, 5}) {
    on_threads(threads, [&] {
      IncrementalInversion inversion(before);
      inversion.update(displacement, changed);
      expect_equal(inversion.field(displacement), invert(displacement));
    });
  }
}

TEST(UnitIncrementalInversion, AVolumeOfOneSliceIsRefused) {
  const Displacement flat{
      unit_geometry({20, 16, 1}),
      field_on(box_topology({0, 0, 0}, {19, 15, 0}), [](const Vec3i&) { return Vec3f(0); })};
  EXPECT_THROW(IncrementalInversion{flat}, InputError);
}
