// Cut bodies that move a little at a time, against an inversion anew.
#include <gtest/gtest.h>

#include "tests/support/sanitized.h"
#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/base/parallel.h"
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

/// Fails the test unless a place has the same offset in both, from within a brick, and sees the
/// same face there and where what is interpolated would.
void expect_same_place(const SplitOffsets& a, const SplitOffsets& b, std::size_t brick,
                       const Vec3d& x) {
  SplitOffsets::Sample one, other;
  const bool found = a.sample(brick, x, one);
  ASSERT_EQ(found, b.sample(brick, x, other)) << x;
  if (!found) return;
  ASSERT_EQ(one.offset, other.offset) << x;
  struct Face {
    Vec3d normal{0, 0, 0};
    double depth_mm = 0;
  } of_one, of_other;
  const Vec3d y = x + one.offset;
  ASSERT_EQ(a.face(one.piece, x, y, of_one.normal, of_one.depth_mm),
            b.face(other.piece, x, y, of_other.normal, of_other.depth_mm))
      << x;
  ASSERT_EQ(of_one.normal, of_other.normal) << x;
  ASSERT_EQ(of_one.depth_mm, of_other.depth_mm) << x;
  ASSERT_EQ(a.face_in_source(-1, y, of_one.normal, of_one.depth_mm),
            b.face_in_source(-1, y, of_other.normal, of_other.depth_mm))
      << x;
  ASSERT_EQ(of_one.normal, of_other.normal) << x;
}

/// Fails the test unless every cell of the bricks that cuts split is the same in both.
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
    ASSERT_EQ(*a.split->interpolated(brick), *b.split->interpolated(brick)) << bricks.origin(brick);
    const Vec3d within = random_place(random, 0, 1);
    for (int cell = 0; cell < kBrickVoxels; ++cell) {
      expect_same_place(*a.split, *b.split, brick,
                        Vec3d(bricks.origin(brick) + brick_local(cell)) + within);
      if (testing::Test::HasFatalFailure()) return;
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
  LEFT_OUT_WHEN_SANITIZED();
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

/// Moves of single voxels and of small balls beside cuts that gape, across the borders of bricks,
/// at the surface as well as within: each is seen in few bricks, and by little.
TEST(PropertyIncrementalCutInversion, SmallMovesBesideGapingCutsLeaveTheBitsOfAnInversionAnew) {
  LEFT_OUT_WHEN_SANITIZED();
  constexpr int kBodies = kSanitized ? 1 : 4, kSteps = kSanitized ? 20 : 40;
  const BrickTopology elements = box_topology({0, 0, 0}, {25, 17, 16});
  const BrickTopology shell = dilate(elements, 2);
  for (int n = 0; n < kBodies; ++n) {
    std::mt19937 random(unsigned(170 + n));
    const auto uniform = [&](double lo, double hi) {
      return std::uniform_real_distribution<double>(lo, hi)(random);
    };
    // A cut near x = 8 or 16, from the upper face down to some depth, oblique, with places or not.
    const double at = n % 2 == 0 ? 7.6 : 15.4, slope = uniform(-0.25, 0.25);
    const double from = uniform(2, 9);
    const auto height = [&](const Vec3d& v) { return v.x - at - slope * (v.z - 8); };
    LinkCuts cuts;
    for (std::size_t b = 0; b < elements.brick_count(); ++b) {
      for_each_active(elements.mask(b), [&](int offset) {
        const Vec3i low = elements.origin(b) + brick_local(offset);
        for (int axis = 0; axis < 3; ++axis) {
          Vec3i high = low;
          ++high[axis];
          const double one = height(Vec3d(low)), other = height(Vec3d(high));
          if ((one < 0) == (other < 0) || low.y < from || !elements.is_active(high)) continue;
          cuts.cut(b, offset, axis, n < 2 ? LinkCuts::place_of(one / (one - other)) : 0);
        }
      });
    }
    const double gape = uniform(0.02, 0.12);
    Displacement displacement = displacement_on(elements, [&](const Vec3i& v) {
      const double opening = gape * std::max(0.0, v.y - from);
      const double fading = std::max(0.0, 1 - std::abs(height(Vec3d(v))) / 9);
      return Vec3f(float(height(Vec3d(v)) < 0 ? -opening * fading : opening * fading), 0, 0);
    });
    const CutElements cut{elements, cuts};
    Displacement before = extend(displacement, shell);
    IncrementalCutInversion inversion(before, cut);
    const VectorBricks at_first = displacement.u;
    for (int step = 0; step < kSteps; ++step) {
      if (step % 10 == 9) displacement.u = at_first;
      const Vec3d centre(at + uniform(-6, 6), uniform(0, 18), uniform(0, 17));
      const double radius = step % 3 == 0 ? 0.9 : uniform(1, 3);
      const double sizes[] = {0.003, 0.03, 0.2, 0.6, 9};  // 9: out of the bricks that it reached
      const Vec3f by = random_vector(random, float(sizes[random() % 5]));
      const bool is_one_sided = random() % 2 == 0;
      for (std::size_t b = 0; b < elements.brick_count(); ++b) {
        for_each_active(elements.mask(b), [&](int offset) {
          const Vec3d v(elements.origin(b) + brick_local(offset));
          if ((v - centre).length() > radius) return;
          if (is_one_sided && (height(v) < 0) != (height(centre) < 0)) return;
          displacement.u.vectors.touch(b)[offset] += by;
        });
      }
      const Displacement extended = extend(displacement, shell);
      inversion.update(extended, changed_bricks(before, extended));
      before = extended;
      const OffsetField anew = invert_cut(extend_past_cuts(displacement, shell, cut), cut);
      const OffsetField field = inversion.field(extended);
      ASSERT_NE(anew.split, nullptr);
      expect_equal(field, anew);
      expect_same_samples(random, field, anew);
      if (HasFatalFailure()) FAIL() << "body " << n << ", step " << step;
    }
  }
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
