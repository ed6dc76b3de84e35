// Bricks that rest need not be stored, and nothing changes: the judge is the same field with every
// brick stored, for which all cells are solved.
#include <gtest/gtest.h>

#include "tests/support/sanitized.h"
#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/field/inversion/forward_offsets.h"
#include "volumes/field/inversion/hidden_elements.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/grid/voxel_sets.h"

using namespace supple;
using namespace supple::test;

namespace {

VectorBricks with_all_stored(VectorBricks field) {
  field.vectors.touch_all();
  return field;
}

VectorBricks without_resting(VectorBricks field) {
  for (std::size_t b = 0; b < field.topology.brick_count(); ++b) {
    if (are_zeros(field.vectors.brick_or_zero(b))) field.vectors.release(b);
  }
  return field;
}

/// Tissue with holes, a sheet and a rod that leave cells incomplete, in 9 x 6 x 5 bricks.
BrickTopology tissue(std::mt19937& random) {
  const Vec3i hole(int(random() % 72), int(random() % 48), int(random() % 40));
  const int empty = int(random() % 9);  // a layer of bricks
  return topology_where(Vec3i(0), {70, 46, 37}, [&, empty, hole](const Vec3i& v) {
    if (v.x >> 3 == empty) return v.y == 11 || (v.y < 3 && v.z < 2);
    const Vec3i d = v - hole;
    return d.dot(d) > 60 && random() % 400 != 0;
  });
}

/// A ball of it gone by a shift and noise; everything else rests.
void move_ball(std::mt19937& random, float shift, VectorBricks& u) {
  const Vec3d center = random_place(random, 4, 44);
  const Vec3f by = random_vector(random, shift);
  const double radius = 3 + double(random() % 7);
  for_each_slot(u.topology, [&](const Vec3i& v, std::size_t slot) {
    if ((Vec3d(v) - center).length() > radius) return;
    u.vectors.set(slot, by + random_vector(random, 0.3F));
  });
}

/// Whole bricks that leave their places, over those below them along x.
void move_half(std::mt19937& random, VectorBricks& u) {
  const int first = 8 + 8 * int(random() % 7);
  const Vec3f by(-8.F - float(random() % 30), 0.25F * float(random() % 3), 0);
  for_each_slot(u.topology, [&](const Vec3i& v, std::size_t slot) {
    if (v.x >= first) u.vectors.set(slot, by);
  });
}

Displacement resting(const BrickTopology& voxels) {
  return {unit_geometry({71, 47, 38}), {voxels, BrickVectors(voxels.brick_count())}};
}

}  // namespace

TEST(PropertyRestingBricks, OffsetsCertificateAndHiddenElementsAreThoseOfAllCellsSolved) {
  std::mt19937 random(61);
  std::int64_t overlapped = 0;
  for (int round = 0; round < (kSanitized ? 6 : 18); ++round) {
    const BrickTopology elements = tissue(random);
    Displacement sparse = resting(dilate(elements, round % 3));
    // Near, over its neighbours, and out of the box.
    for (int balls = round % 4; balls > 0; --balls) {
      move_ball(random, round % 5 == 0 ? 0.F : round % 5 == 4 ? 30.F : 4.F, sparse.u);
    }
    if (round % 6 == 5) move_half(random, sparse.u);
    const Displacement all{sparse.geometry, with_all_stored(sparse.u)};
    sparse.u = without_resting(std::move(sparse.u));
    InvertParams params;
    if (round % 2 == 1) params.material = &elements;
    const OffsetField found = invert(sparse, params), wanted = invert(all, params);
    expect_equal(found, wanted);
    EXPECT_TRUE(found.overlaps == wanted.overlaps);
    EXPECT_EQ(count_hidden(sparse, elements, found), count_hidden(all, elements, wanted));
    overlapped += wanted.certificate.overlapped_voxels;
    const ForwardOffsets quick(sparse), slow(all);
    EXPECT_TRUE(quick.bricks() == slow.bricks());
  }
  EXPECT_GT(overlapped, 0);
}

TEST(PropertyRestingBricks, FollowedThroughChangesTheyGiveTheSameBits) {
  std::mt19937 random(62);
  for (int round = 0; round < cases(4); ++round) {
    Displacement u = resting(tissue(random));
    IncrementalInversion inversion(u);
    for (int step = 0; step < 5; ++step) {
      const VectorBricks before = u.u;
      if (step == 3) u.u.vectors = BrickVectors(u.u.topology.brick_count());  // back to rest
      if (step == 4 || (step == 0 && round % 2 == 1)) move_half(random, u.u);
      if (step != 3) move_ball(random, step == 1 ? 20.F : 3.F, u.u);
      u.u = without_resting(std::move(u.u));
      std::vector<std::int32_t> changed;
      for (std::size_t b = 0; b < u.u.topology.brick_count(); ++b) {
        const Vec3f* const now = u.u.vectors.brick_or_zero(b);
        if (!std::equal(now, now + kBrickVoxels, before.vectors.brick_or_zero(b))) {
          changed.push_back(std::int32_t(b));
        }
      }
      inversion.update(u, changed);
      expect_equal(inversion.field(u), invert({u.geometry, with_all_stored(u.u)}));
    }
  }
}

TEST(PropertyRestingBricks, AnInverseThatCoversWhatWasThereSharesItsBricks) {
  Displacement u = resting(box_topology(Vec3i(0), {70, 46, 37}));
  EXPECT_EQ(&invert(u).o.topology.mask(0), &u.u.topology.mask(0));
  u.u.vectors.touch(u.u.topology.find({32, 16, 16}) + 0U)[100] = Vec3f(0.25F, 0, 0);
  const OffsetField inside = invert(u);
  EXPECT_EQ(inside.o.vectors.stored_bricks(), 1U);
  EXPECT_EQ(&inside.o.topology.mask(0), &u.u.topology.mask(0));
  // A voxel of the border that left the box.
  u.u.vectors.touch(0)[0] = Vec3f(-1.25F, 0, 0);
  EXPECT_FALSE(invert(u).o.topology == u.u.topology);
}
