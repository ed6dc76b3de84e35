// Cut bodies that move a little at a time, against an inversion anew.
#include <gtest/gtest.h>

#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/base/on_threads.h"
#include "volumes/field/cuts/cut_offsets.h"
#include "volumes/field/split_offsets.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Cuts the links across a plane, up to a radius; in half of the cases it is known where they are
/// crossed.
void cut_at_random(std::mt19937& random, const BrickTopology& elements, LinkCuts& cuts) {
  const Vec3d place = random_place(random, 8, 18) * Vec3d(1.7, 1, 1);
  const Vec3d normal(random_vector(random, 1));
  const double radius = std::uniform_real_distribution<double>(4, 20)(random);
  const bool has_places = random() % 2 == 0;
  const auto height = [&](const Vec3i& v) { return (Vec3d(v) - place).dot(normal); };
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for_each_active(elements.mask(b), [&](int offset) {
      const Vec3i low = elements.origin(b) + brick_local(offset);
      for (int axis = 0; axis < 3; ++axis) {
        Vec3i high = low;
        ++high[axis];
        const bool crosses = (height(low) < 0) != (height(high) < 0);
        if (!elements.is_active(high) || !crosses) continue;
        if ((Vec3d(low) - place).length() >= radius) continue;
        const double fraction = height(low) / (height(low) - height(high));
        cuts.cut(b, offset, axis, has_places ? LinkCuts::place_of(fraction) : LinkCuts::Place(0));
      }
    });
  }
}

/// Moves the voxels of a ball, those on either side of a plane their own way; most balls are small.
void move_ball(std::mt19937& random, VectorBricks& u, float size) {
  const Vec3d centre = random_place(random, 2, 24) * Vec3d(1.7, 1, 1);
  const Vec3d normal(random_vector(random, 1));
  const double radius =
      std::uniform_real_distribution<double>(1, random() % 3 == 0 ? 9 : 3)(random);
  const Vec3f one = random_vector(random, size), other = random_vector(random, size);
  for (std::size_t b = 0; b < u.topology.brick_count(); ++b) {
    for_each_active(u.topology.mask(b), [&](int offset) {
      const Vec3d d = Vec3d(u.topology.origin(b) + brick_local(offset)) - centre;
      if (d.length() > radius) return;
      u.vectors.touch(b)[offset] = d.dot(normal) < 0 ? one : other;
    });
  }
}

/// Bricks with other vectors.
BrickList changed_bricks(const Displacement& before, const Displacement& now) {
  return bricks_where(all_bricks(now.u.topology), [&](std::size_t b) {
    const Vec3f* const vectors = now.u.vectors.brick_or_zero(b);
    return !std::equal(vectors, vectors + kBrickVoxels, before.u.vectors.brick_or_zero(b));
  });
}

/// Fails the test unless every sample of both is the same, too, and sees the same face.
void expect_same_samples(std::mt19937& random, const OffsetField& a, const OffsetField& b) {
  ASSERT_EQ(a.split == nullptr, b.split == nullptr);
  EXPECT_TRUE(a.overlaps == b.overlaps);
  EXPECT_EQ(a.certificate.torn_cells, b.certificate.torn_cells);
  for (int n = 0; n < 2000; ++n) {
    const Vec3d x = random_place(random, -2, 30) * Vec3d(1.6, 1, 1);
    Vec3d one(0), other(0);
    ASSERT_EQ(a.sample(x, one), b.sample(x, other)) << x;
    ASSERT_EQ(one, other) << x;
  }
  if (a.split == nullptr) return;
  const BrickTopology& bricks = a.split->bricks();
  ASSERT_TRUE(bricks == b.split->bricks());
  for (std::size_t brick = 0; brick < bricks.brick_count(); ++brick) {
    ASSERT_EQ(*a.split->interpolated(brick), *b.split->interpolated(brick));
    for (int n = 0; n < 40; ++n) {
      const Vec3d x = Vec3d(bricks.origin(brick)) + random_place(random, 0, 8);
      SplitOffsets::Sample one, other;
      const bool found = a.split->sample(brick, x, one);
      ASSERT_EQ(found, b.split->sample(brick, x, other)) << x;
      if (!found) continue;
      ASSERT_EQ(one.offset, other.offset) << x;
      struct Face {
        Vec3d normal{0, 0, 0};
        double depth_mm = 0;
      } of_one, of_other;
      const Vec3d y = x + one.offset;
      ASSERT_EQ(a.split->face(one.piece, x, y, of_one.normal, of_one.depth_mm),
                b.split->face(other.piece, x, y, of_other.normal, of_other.depth_mm))
          << x;
      ASSERT_EQ(of_one.normal, of_other.normal) << x;
      ASSERT_EQ(of_one.depth_mm, of_other.depth_mm) << x;
      ASSERT_EQ(a.split->face_in_source(-1, y, of_one.normal, of_one.depth_mm),
                b.split->face_in_source(-1, y, of_other.normal, of_other.depth_mm))
          << x;
      ASSERT_EQ(of_one.normal, of_other.normal) << x;
    }
  }
}

/// A body with its cuts, and the bodies that it was before and after.
struct BodyWithHistory {
  struct At {
    VectorBricks u;
    LinkCuts cuts;
  };
  std::vector<At> steps;
  std::size_t now = 0;

  const At& body() const { return steps[now]; }
  /// A cut or a drag, or one of them taken back or made again.
  void change(std::mt19937& random, const BrickTopology& elements) {
    const unsigned kind = unsigned(random()) % 8;
    if (kind < 2 && now > 0) {
      --now;
    } else if (kind == 2 && now + 1 < steps.size()) {
      ++now;
    } else {
      steps.resize(now + 1);
      At next = body();
      if (kind == 3 || now == 0) cut_at_random(random, elements, next.cuts);
      if (kind != 3) move_ball(random, next.u, 0.3f * float(random() % 6));
      steps.push_back(std::move(next));
      ++now;
    }
  }
};

}  // namespace

TEST(PropertyIncrementalCutInversion, AfterEveryCutDragUndoAndRedoItHasTheBitsOfAnInversionAnew) {
  constexpr int kBodies = 2;
  int torn = 0;
  for (int n = 0; n < kBodies; ++n) {
    std::mt19937 random(unsigned(70 + n));
    const BrickTopology elements = box_topology({0, 0, 0}, {44, 26, 25});
    InvertParams params;
    if (n % 2 == 0) params.material = &elements;
    Displacement displacement = displacement_on(elements, [](const Vec3i&) { return Vec3f(0); });
    const BrickTopology shell = dilate(elements, n < 1 ? 2 : 1);
    BodyWithHistory body{{{displacement.u, LinkCuts()}}};
    Displacement before = extend(displacement, shell);
    IncrementalCutInversion inversion(before, {elements, {}}, params);
    for (int step = 0; step < 24; ++step) {
      body.change(random, elements);
      displacement.u = body.body().u;
      const Displacement extended = extend(displacement, shell);
      const CutElements cut{elements, body.body().cuts};
      inversion.set_cuts(cut.cuts);
      inversion.update(extended, changed_bricks(before, extended));
      before = extended;
      const OffsetField anew = invert_cut(extend_past_cuts(displacement, shell, cut), cut, params);
      const OffsetField field = inversion.field(extended);
      expect_equal(field, anew);
      expect_same_samples(random, field, anew);
      if (HasFatalFailure()) FAIL() << "body " << n << ", step " << step;
      torn += anew.split != nullptr;
    }
  }
  EXPECT_GT(torn, 4 * kBodies);
}

/// Work is counted, not timed: what is far from a change is left alone.
TEST(PropertyIncrementalCutInversion, OnlyWhatAChangeReachesIsExtendedInvertedAndSplitAnew) {
  const BrickTopology elements = box_topology({0, 0, 0}, {151, 23, 23});
  const BrickTopology shell = dilate(elements, 2);
  LinkCuts cuts;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for_each_active(elements.mask(b), [&](int offset) {
      const Vec3i low = elements.origin(b) + brick_local(offset);
      if (low.x % 24 == 11 && low.y >= 8) cuts.cut(b, offset, 0, 256);
    });
  }
  // Five cuts that gape towards the upper face.
  const auto gaping = [](const Vec3i& v) {
    const double beside = (v.x + 12) % 24 - 11.5;
    return v.x < 120 && v.y > 7 ? Vec3f(float(0.02 * (v.y - 7) * (beside < 0 ? -1 : 1)), 0, 0)
                                : Vec3f(0);
  };
  Displacement displacement = displacement_on(elements, gaping);
  Displacement before = extend(displacement, shell);
  IncrementalCutInversion inversion(before, {elements, cuts});
  ASSERT_NE(inversion.split(), nullptr);
  const std::size_t split = inversion.split()->bricks().brick_count();
  EXPECT_GT(split, 40u);
  const auto drag = [&](const Vec3i& lo, const Vec3i& hi) {
    for (std::size_t b = 0; b < elements.brick_count(); ++b) {
      for_each_active(elements.mask(b), [&](int offset) {
        const Vec3i voxel = elements.origin(b) + brick_local(offset);
        if (IndexBox{lo, hi}.contains(voxel)) {
          displacement.u.vectors.touch(b)[offset] += Vec3f(0, 0.1F, 0);
        }
      });
    }
    const Displacement extended = extend(displacement, shell);
    const std::vector<Vec3i> touched = inversion.update(extended, changed_bricks(before, extended));
    before = extended;
    EXPECT_LT(touched.size(), 60u);
    return inversion.work();
  };
  IncrementalCutInversion::Work work = drag({138, 10, 10}, {142, 14, 14});
  EXPECT_EQ(work.extended_bricks, 0);
  EXPECT_EQ(work.split_bricks, 0);
  EXPECT_GT(work.inverted_bricks, 0);
  EXPECT_LT(work.inverted_bricks, 30);
  work = drag({16, 18, 10}, {20, 21, 14});  // at the upper face, five voxels beside a cut
  EXPECT_GT(work.split_bricks, 0);
  EXPECT_LT(work.split_bricks, std::int64_t(split) / 4);
  EXPECT_GT(work.extended_bricks, 0);
  EXPECT_LT(work.extended_bricks, 40);
  EXPECT_LT(work.inverted_bricks, 40);
  work = drag({0, 0, 0}, {-1, -1, -1});
  EXPECT_EQ(work.extended_bricks + work.split_bricks + work.inverted_bricks, 0);
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
        inversion.update(displacement, all_bricks(elements));
      }
      field = inversion.field(displacement);
    });
    return field;
  };
  expect_equal(moved_on(1), moved_on(3));
}
