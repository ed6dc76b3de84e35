// Points that go along with a body and back (point_motion.h).
#include <gtest/gtest.h>

#include "tests/support/random_state.h"
#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/field/offset_field.h"
#include "volumes/field/points/point_motion.h"

using namespace supple;
using namespace supple::test;

namespace {

/// A body of its elements and two rings around them, with its inverse.
struct MovedBody {
  BrickTopology elements;
  LinkCuts cuts;
  Displacement extended;
  OffsetField offsets;

  MovedBody(const BrickTopology& body, const LinkCuts& cut, const Geometry& geometry,
            const std::function<Vec3f(const Vec3i&)>& u)
      : elements(body), cuts(cut) {
    const Vec3i lo = body.active_bounds().lo - Vec3i(2), hi = body.active_bounds().hi + Vec3i(2);
    extended =
        extend_past_cuts({geometry, field_on(body, u)}, box_topology(lo, hi), {elements, cuts});
    offsets = invert_cut(extended, {elements, cuts});
  }

  std::unique_ptr<PointMotion> along() const { return motion_along(extended, {elements, cuts}); }
  std::unique_ptr<PointMotion> to_rest() const {
    return motion_to_rest(extended, {elements, cuts}, offsets);
  }
};

LinkCuts cut_at_x(const BrickTopology& elements, int low_x) {
  LinkCuts cuts;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for_each_active(elements.mask(b), [&](int offset) {
      const Vec3i low = elements.origin(b) + brick_local(offset);
      if (low.x == low_x && elements.is_active(low + Vec3i(1, 0, 0))) cuts.cut(b, offset, 0);
    });
  }
  return cuts;
}

const Geometry kOblique{
    {24, 22, 20}, {5, -7, 9}, {Vec3d(0, 0.8, 0.1), {-1.1, 0, 0}, {0, 0.2, 1.5}}};

}  // namespace

TEST(PropertyPointMotion, ThereAndBackAgainEndsWithinAHundredThousandthOfAVoxel) {
  // docs/apply.md, wherever nothing folds.
  std::mt19937 random(61);
  for (const float size : {0.02f, 0.14f}) {
    const MovedBody body(box_topology({3, 3, 3}, {18, 17, 15}), {}, kOblique, [&](const Vec3i&) {
      return Vec3f(4, -2.5f, 1) + random_vector(random, size);
    });
    ASSERT_EQ(body.offsets.certificate.folded_cells, 0);
    const auto along = body.along(), to_rest = body.to_rest();
    double worst = 0;
    for (int n = 0; n < 2000; ++n) {
      const Vec3d X = kOblique.world_from_index(random_place(random, 3, 15));
      const MovedPoint back = to_rest->move(along->move(X).to_lps_mm);
      worst = std::max(worst, kOblique.index_vector_from_world(back.to_lps_mm - X).length());
    }
    EXPECT_LE(worst, 1e-5) << size;
    EXPECT_GT(worst, 0);
  }
}

TEST(UnitPointMotion, ATranslatedBodyTakesPointsInsideAndBesideItAlong) {
  const MovedBody body(box_topology({4, 4, 4}, {15, 15, 15}), {}, kOblique,
                       [](const Vec3i&) { return Vec3f(2, -1.5f, 0.25f); });
  const Vec3d by = kOblique.world_vector_from_index({2, -1.5, 0.25});
  for (const Vec3d& index : {Vec3d(8.3, 9.1, 7.7), Vec3d(4, 4, 4), Vec3d(-30, 60, 7)}) {
    const Vec3d X = kOblique.world_from_index(index);
    const MovedPoint moved = body.along()->move(X), back = body.to_rest()->move(X + by);
    EXPECT_LT((moved.to_lps_mm - X - by).length(), 1e-9) << index;
    EXPECT_LT((back.to_lps_mm - X).length(), 1e-9) << index;
    const PlaceKind kind = index.x < 0 ? PlaceKind::outside : PlaceKind::inside;
    EXPECT_EQ(moved.kind, kind);
    EXPECT_EQ(back.kind, kind);
  }
}

TEST(UnitPointMotion, AnAffineBodyMovesPointsAndGradientsByItsMatrix) {
  // u = G X with G in the index frame, so that all values below are exact.
  const Columns G = {Vec3d(0.25, 0.125, 0), Vec3d(0, -0.125, 0.0625), Vec3d(0.125, 0, 0.25)};
  const MovedBody body(box_topology({4, 4, 4}, {15, 15, 15}), {}, kOblique,
                       [&](const Vec3i& v) { return Vec3f(product(G, Vec3d(v))); });
  Columns F = G;
  for (int a = 0; a < 3; ++a) F[a][a] += 1;
  const Columns world = in_world(kOblique, F);
  const Vec3d index(7.3, 9.9, 11.2), X = kOblique.world_from_index(index);
  const Vec3d x = kOblique.world_from_index(product(F, index));
  const MovedPoint moved = body.along()->move(X), back = body.to_rest()->move(x);
  EXPECT_LT((moved.to_lps_mm - x).length(), 1e-6);
  EXPECT_LT((back.to_lps_mm - X).length(), 1e-5);
  for (int a = 0; a < 3; ++a) {
    EXPECT_LT((moved.gradient[a] - world[a]).length(), 1e-6);
    Vec3d unit(0);
    unit[a] = 1;
    EXPECT_LT((product(back.gradient, world[a]) - unit).length(), 1e-5);
  }
}

TEST(PropertyPointMotion, ThereAndBackAgainIsTheSamePlaceOffFolds) {
  double worst = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    std::mt19937 random(seed);
    const Geometry geometry = random_geometry(random, {24, 24, 24});
    const BrickTopology ball = topology_where({4, 4, 4}, {19, 19, 19}, [](const Vec3i& v) {
      return (Vec3d(v) - Vec3d(11.5)).length() < 7.6;
    });
    const Vec3f shift = random_vector(random, 6);
    const MovedBody body(ball, {}, geometry,
                         [&](const Vec3i&) { return shift + random_vector(random, 0.16f); });
    const auto along = body.along(), to_rest = body.to_rest();
    int inside = 0;
    for (int n = 0; n < 1500; ++n) {
      const Vec3d X = geometry.world_from_index(random_place(random, 2, 21));
      const MovedPoint there = along->move(X);
      if (there.kind != PlaceKind::inside) continue;
      const MovedPoint back = to_rest->move(there.to_lps_mm);
      if (back.kind == PlaceKind::folded) continue;
      ASSERT_EQ(back.kind, PlaceKind::inside) << n;
      worst = std::max(worst, geometry.index_vector_from_world(back.to_lps_mm - X).length());
      const MovedPoint again = along->move(back.to_lps_mm);
      worst = std::max(
          worst, geometry.index_vector_from_world(again.to_lps_mm - there.to_lps_mm).length());
      ++inside;
    }
    EXPECT_GT(inside, 500) << seed;
  }
  EXPECT_LT(worst, 1e-3);
}

TEST(PropertyPointMotion, TheWayBackHasTheOffsetsOfTheInverse) {
  std::mt19937 random(3);
  const MovedBody body(
      box_topology({4, 4, 4}, {15, 15, 15}), {}, unit_geometry({20, 20, 20}),
      [&](const Vec3i&) { return Vec3f(1, 2, -3) + random_vector(random, 0.15f); });
  ASSERT_EQ(body.offsets.certificate.folded_cells, 0);
  const auto to_rest = body.to_rest();
  int nodes = 0;
  for_each_slot(body.offsets.o.topology, [&](const Vec3i& x, std::size_t slot) {
    const MovedPoint moved = to_rest->move(Vec3d(x));
    const Vec3d expected = Vec3d(x) + Vec3d(body.offsets.o.vectors.at(slot));
    EXPECT_LT((moved.to_lps_mm - expected).length(), 1e-3) << x;
    ++nodes;
  });
  EXPECT_GT(nodes, 1000);
}

TEST(PropertyPointMotion, PointsBesideAnOpenCutGoWithTheirOwnSide) {
  const BrickTopology block = box_topology({4, 4, 4}, {23, 19, 19});
  const MovedBody body(block, cut_at_x(block, 13), unit_geometry({28, 24, 24}),
                       [](const Vec3i& v) { return Vec3f(v.x <= 13 ? -2.f : 2.f, 0, 0); });
  ASSERT_NE(body.offsets.split, nullptr);
  const auto along = body.along(), to_rest = body.to_rest();
  for (const double x : {5.0, 12.9, 13.2, 13.499, 13.501, 13.8, 14.1, 21.0}) {
    const Vec3d X(x, 10.3, 11.6), by(x < 13.5 ? -2 : 2, 0, 0);
    const MovedPoint moved = along->move(X);
    EXPECT_LT((moved.to_lps_mm - X - by).length(), 1e-6) << x;
    EXPECT_EQ(moved.kind, PlaceKind::inside);
    const MovedPoint back = to_rest->move(moved.to_lps_mm);
    EXPECT_LT((back.to_lps_mm - X).length(), 1e-3) << x;
    EXPECT_EQ(back.kind, PlaceKind::inside);
  }
  for (const double x : {11.7, 13.5, 15.3}) {
    EXPECT_EQ(to_rest->move({x, 10, 10}).kind, PlaceKind::torn) << x << " lies in the gap";
  }
}

TEST(PropertyPointMotion, SidesOfACutThatOverlapByLessThanAVoxelAreNamed) {
  const BrickTopology block = box_topology({4, 4, 4}, {23, 19, 19});
  const MovedBody body(block, cut_at_x(block, 13), unit_geometry({28, 24, 24}),
                       [](const Vec3i& v) { return Vec3f(v.x <= 13 ? 0.45f : -0.4f, 2, 0); });
  ASSERT_NE(body.offsets.split, nullptr);
  ASSERT_EQ(body.offsets.certificate.overlapped_voxels, 0);
  for (double x = 13.02; x < 14; x += 0.06) {
    const bool is_both = x > 13.1 && x < 13.95;
    EXPECT_EQ(body.to_rest()->move({x, 10.3, 11.6}).kind,
              is_both ? PlaceKind::folded : PlaceKind::inside)
        << x;
  }
}

TEST(PropertyPointMotion, FoldsAreNamedOnBothWays) {
  // Between x = 9 and x = 10 the body turns inside out.
  const MovedBody body(box_topology({4, 4, 4}, {15, 15, 15}), {}, unit_geometry({20, 20, 20}),
                       [](const Vec3i& v) { return Vec3f(v.x < 10 ? 0.f : -3.f, 0, 0); });
  EXPECT_EQ(body.along()->move({9.5, 8, 8}).kind, PlaceKind::folded);
  EXPECT_EQ(body.along()->move({8.5, 8, 8}).kind, PlaceKind::inside);
  const MovedPoint back = body.to_rest()->move({8.25, 8, 8});
  EXPECT_EQ(back.kind, PlaceKind::folded);
  EXPECT_LT((back.to_lps_mm - Vec3d(8.25, 8, 8)).length(), 1e-4) << "the shortest way";
  EXPECT_EQ(body.to_rest()->move({5.5, 8, 8}).kind, PlaceKind::inside);
}

TEST(PropertyPointMotion, OfSeveralPlacesTheOneWithTheShortestWayCounts) {
  // Three come to x = 9.3: 8.8, 9.1 in the cell that is turned inside out, and 11.8.
  const MovedBody body(box_topology({4, 4, 4}, {15, 15, 15}), {}, unit_geometry({20, 20, 20}),
                       [](const Vec3i& v) { return Vec3f(v.x < 10 ? 0.5f : -2.5f, 0, 0); });
  const MovedPoint back = body.to_rest()->move({9.3, 8.2, 8.6});
  EXPECT_LT((back.to_lps_mm - Vec3d(9.1, 8.2, 8.6)).length(), 1e-4) << back.to_lps_mm;
  EXPECT_EQ(back.kind, PlaceKind::folded);
}

TEST(PropertyPointMotion, FoldsBesideAnOpenCutAreNamedOnTheWayBack) {
  const BrickTopology block = box_topology({4, 4, 4}, {23, 19, 19});
  const MovedBody body(block, cut_at_x(block, 13), unit_geometry({28, 24, 24}), [](const Vec3i& v) {
    const float x = v.x <= 13 ? -3.f : 3.f;
    return Vec3f(x, v.y < 10 ? 0.f : -2.f, 0);
  });
  const Vec3d X(13.3, 9.5, 11);
  const MovedPoint there = body.along()->move(X);
  EXPECT_EQ(there.kind, PlaceKind::folded);
  EXPECT_EQ(body.to_rest()->move(there.to_lps_mm).kind, PlaceKind::folded);
  // A place that two others come to as well, in cells that do not fold themselves.
  EXPECT_EQ(body.to_rest()->move({16.7, 8.6, 11}).kind, PlaceKind::folded);
}

TEST(PropertyPointMotion, BeyondTheBodyThereAndBackAgainIsStillTheSamePlace) {
  std::mt19937 random(8);
  const MovedBody body(
      box_topology({12, 12, 12}, {35, 35, 35}), {}, unit_geometry({48, 48, 48}),
      [](const Vec3i& v) { return Vec3f(0.1f * float(v.y) - 2, 0.05f * float(v.x), 1); });
  const auto along = body.along(), to_rest = body.to_rest();
  int outside = 0, folded = 0;
  for (int n = 0; n < 600; ++n) {
    const Vec3d X = random_place(random, -20, 70);
    const MovedPoint there = along->move(X), back = to_rest->move(there.to_lps_mm);
    if (there.kind != PlaceKind::outside) continue;
    EXPECT_NE(back.kind, PlaceKind::unresolved);
    EXPECT_LT((along->move(back.to_lps_mm).to_lps_mm - there.to_lps_mm).length(), 1e-4) << X;
    ++outside;
    folded += (back.to_lps_mm - X).length() > 1e-3;
  }
  EXPECT_GT(outside, 300);
  EXPECT_EQ(folded, 0);
}

TEST(UnitPointMotion, PlacesBeyondAllNumbersAreOutside) {
  const MovedBody body(box_topology({4, 4, 4}, {15, 15, 15}), {}, unit_geometry({20, 20, 20}),
                       [](const Vec3i&) { return Vec3f(1, 0, 0); });
  for (const double far : {1e8, -1e12, 1e300}) {
    EXPECT_EQ(body.along()->move({far, 0, 0}).kind, PlaceKind::outside);
    EXPECT_EQ(body.to_rest()->move({far, 0, 0}).kind, PlaceKind::outside);
  }
}

TEST(UnitPointMotion, ASliceIsMovedInItsPlane) {
  const BrickTopology slice = box_topology({4, 4, 0}, {15, 15, 0});
  LinkCuts none;
  const Displacement u{unit_geometry({20, 20, 1}),
                       field_on(slice, [](const Vec3i&) { return Vec3f(1.5f, 2, 0); })};
  const OffsetField offsets = invert_cut(u, {slice, none});
  const MovedPoint moved = motion_along(u, {slice, none})->move({8.2, 9.4, 0});
  EXPECT_EQ(moved.to_lps_mm, Vec3d(9.7, 11.4, 0));
  EXPECT_EQ(moved.kind, PlaceKind::inside);
  EXPECT_EQ(motion_along(u, {slice, none})->move({8.2, 9.4, 0.25}).kind, PlaceKind::inside);
  const MovedPoint back = motion_to_rest(u, {slice, none}, offsets)->move({9.7, 11.4, 0});
  EXPECT_LT((back.to_lps_mm - Vec3d(8.2, 9.4, 0)).length(), 1e-6);
  EXPECT_EQ(back.kind, PlaceKind::inside);
}
