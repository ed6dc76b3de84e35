// Cut bodies that move a little at a time, against an inversion anew.
#include <gtest/gtest.h>

#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/base/on_threads.h"
#include "volumes/field/cuts/cut_offsets.h"
#include "volumes/field/split_offsets.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Cuts the links across a plane, up to a radius, and some others.
void cut_at_random(std::mt19937& random, const BrickTopology& elements, LinkCuts& cuts) {
  const Vec3d place = random_place(random, 8, 22), normal(random_vector(random, 1));
  const double radius = std::uniform_real_distribution<double>(4, 20)(random);
  const auto height = [&](const Vec3i& v) { return (Vec3d(v) - place).dot(normal); };
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for_each_active(elements.mask(b), [&](int offset) {
      const Vec3i low = elements.origin(b) + brick_local(offset);
      for (int axis = 0; axis < 3; ++axis) {
        Vec3i high = low;
        ++high[axis];
        const bool crosses = (height(low) < 0) != (height(high) < 0);
        if (!elements.is_active(high) || !crosses) continue;
        if ((Vec3d(low) - place).length() < radius) cuts.cut(b, offset, axis);
      }
    });
  }
}

/// Moves the voxels of a ball, those on either side of a plane their own way.
void move_ball(std::mt19937& random, VectorBricks& u, float size) {
  const Vec3d centre = random_place(random, 4, 26), normal(random_vector(random, 1));
  const double radius = std::uniform_real_distribution<double>(2, 9)(random);
  const Vec3f one = random_vector(random, size), other = random_vector(random, size);
  for (std::size_t b = 0; b < u.topology.brick_count(); ++b) {
    for_each_active(u.topology.mask(b), [&](int offset) {
      const Vec3d d = Vec3d(u.topology.origin(b) + brick_local(offset)) - centre;
      if (d.length() > radius) return;
      u.vectors.touch(b)[offset] = d.dot(normal) < 0 ? one : other;
    });
  }
}

/// Fails the test unless every sample of both is the same, too.
void expect_same_samples(std::mt19937& random, const OffsetField& a, const OffsetField& b) {
  ASSERT_EQ(a.split == nullptr, b.split == nullptr);
  EXPECT_TRUE(a.overlaps == b.overlaps);
  EXPECT_EQ(a.certificate.torn_cells, b.certificate.torn_cells);
  for (int n = 0; n < 2000; ++n) {
    const Vec3d x = random_place(random, -2, 32);
    Vec3d one(0), other(0);
    ASSERT_EQ(a.sample(x, one), b.sample(x, other)) << x;
    ASSERT_EQ(one, other) << x;
  }
}

}  // namespace

TEST(PropertyIncrementalCutInversion, AfterEveryLocalChangeItHasTheBitsOfAnInversionAnew) {
  constexpr int kBodies = 3;
  int torn = 0;
  for (int n = 0; n < kBodies; ++n) {
    std::mt19937 random(unsigned(70 + n));
    const BrickTopology elements = box_topology({0, 0, 0}, {30, 28, 29});
    LinkCuts cuts;
    InvertParams params;
    if (n % 2 == 0) params.material = &elements;
    Displacement displacement = displacement_on(elements, [](const Vec3i&) { return Vec3f(0); });
    const BrickTopology shell = dilate(elements, n < 2 ? 2 : 0);
    IncrementalCutInversion inversion(extend(displacement, shell), {elements, cuts}, params);
    for (int step = 0; step < 7; ++step) {
      if (step % 3 == 0) cut_at_random(random, elements, cuts);
      const float size = step % 4 == 3 ? 0 : 0.3f * float(1 + step % 5);
      move_ball(random, displacement.u, size);
      inversion.update(extend(displacement, shell));
      const OffsetField anew = invert_cut(extend_past_cuts(displacement, shell, {elements, cuts}),
                                          {elements, cuts}, params);
      expect_equal(inversion.field(), anew);
      expect_same_samples(random, inversion.field(), anew);
      torn += anew.split != nullptr;
    }
  }
  EXPECT_GT(torn, 2 * kBodies);
}

TEST(PropertyIncrementalCutInversion, DoesNotDependOnTheNumberOfThreads) {
  const BrickTopology elements = box_topology({0, 0, 0}, {30, 28, 29});
  const auto moved_on = [&](int threads) {
    std::mt19937 random(5);
    LinkCuts cuts;
    cut_at_random(random, elements, cuts);
    Displacement displacement = displacement_on(elements, [](const Vec3i&) { return Vec3f(0); });
    OffsetField field;
    on_threads(threads, [&] {
      IncrementalCutInversion inversion(displacement, {elements, cuts});
      for (int step = 0; step < 3; ++step) {
        move_ball(random, displacement.u, 1);
        inversion.update(displacement);
      }
      field = inversion.field();
    });
    return field;
  };
  expect_equal(moved_on(1), moved_on(3));
}
