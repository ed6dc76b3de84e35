// Where tissue and air come to the same place, tissue is seen (design.md section 4).
#include <gtest/gtest.h>

#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/field/cuts/cut_offsets.h"
#include "volumes/field/inversion/deformed_cell.h"
#include "volumes/field/inversion/forward_offsets.h"
#include "volumes/field/inversion/hidden_elements.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/field/inversion/source_cells.h"
#include "volumes/field/points/point_motion.h"
#include "volumes/grid/voxel_sets.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr int kAirRings = 2;

/// Tissue with the air that goes along with it, and its offsets.
struct Body {
  Body(const Vec3i& dims, const BrickTopology& tissue, const std::function<Vec3f(const Vec3i&)>& u)
      : elements(tissue),
        displacement(extend({unit_geometry(dims), field_on(tissue, u)},
                            dilate_inside(tissue, kAirRings, dims))) {
    InvertParams params;
    params.material = &elements;
    offsets = invert(displacement, params);
  }
  std::int64_t hidden() const { return count_hidden(displacement, elements, offsets); }

  BrickTopology elements;
  Displacement displacement;
  OffsetField offsets;
};

/// Two slabs of 10 x 10 x 6 voxels, 6 apart, the upper one lowered or the lower one raised.
struct Slabs : Body {
  static constexpr int kVoxels = 600;
  enum class Moved { upper, lower };

  explicit Slabs(float by, Moved moved = Moved::upper)
      : Body({14, 14, 26},
             unite(box_topology({2, 2, 4}, {11, 11, 9}), box_topology({2, 2, 16}, {11, 11, 21})),
             [&](const Vec3i& v) {
               const bool moves = (v.z < 13) == (moved == Moved::lower);
               return Vec3f(0, 0, moves ? (v.z < 13 ? by : -by) : 0);
             }) {}

  /// Voxels of tissue that are not read where they are now.
  int lost() const {
    int count = 0;
    for_each_slot(elements, [&](const Vec3i& v, std::size_t) {
      Vec3f u(0), o(0);
      displacement.u.at(v, u);
      count += !offsets.o.at(v + Vec3i(u), o) || o != -u;
    });
    return count;
  }
};

}  // namespace

TEST(PropertyTissueOverAir, ASlabThatComesNearAnotherLosesNothing) {
  for (const float lowered : {1.0f, 3.0f, 4.0f, 5.0f, 6.0f}) {
    const Slabs slabs(lowered);
    EXPECT_EQ(slabs.lost(), 0) << lowered;
    EXPECT_EQ(slabs.hidden(), 0) << lowered;
    EXPECT_EQ(slabs.offsets.certificate.overlapped_voxels, 0) << lowered;
    EXPECT_EQ(slabs.offsets.certificate.folded_cells, 0) << lowered;
  }
}

TEST(PropertyTissueOverAir, SlabsThatPassThroughEachOtherAreCounted) {
  for (const Slabs::Moved moved : {Slabs::Moved::upper, Slabs::Moved::lower}) {
    const Slabs half(9, moved), same(12, moved);
    // Three of six layers lie in the other slab, which did not move.
    EXPECT_EQ(half.lost(), Slabs::kVoxels / 2);
    EXPECT_EQ(half.hidden(), Slabs::kVoxels / 2);
    EXPECT_EQ(half.offsets.certificate.overlapped_voxels, Slabs::kVoxels / 2);
    EXPECT_EQ(half.offsets.overlaps.active_count(), Slabs::kVoxels / 2);
    const bool is_upper = moved == Slabs::Moved::upper;
    EXPECT_TRUE(half.offsets.overlaps.is_active({5, 5, is_upper ? 9 : 16}));
    EXPECT_FALSE(half.offsets.overlaps.is_active({5, 5, is_upper ? 10 : 15}));
    EXPECT_EQ(same.lost(), Slabs::kVoxels);
    EXPECT_EQ(same.hidden(), Slabs::kVoxels);
    EXPECT_EQ(same.offsets.certificate.overlapped_voxels, Slabs::kVoxels);
  }
}

TEST(PropertyTissueOverAir, PassedThroughTheOtherSlabIsFree) {
  const Slabs through(18);
  EXPECT_EQ(through.lost(), 0);
  EXPECT_EQ(through.hidden(), 0);
}

TEST(PropertyTissueOverAir, AVoxelOfACheckerboardIsSeenWhereItWent) {
  const Vec3i dims(24, 24, 24);
  const auto is_tissue = [](const Vec3i& v) { return (v.x + v.y + v.z) % 2 == 0; };
  const BrickTopology board = topology_where({2, 2, 2}, {12, 12, 12}, is_tissue);
  const Vec3i dragged(7, 7, 6);
  const Body body(dims, board,
                  [&](const Vec3i& v) { return v == dragged ? Vec3f(7, 3, 1) : Vec3f(0); });
  Vec3f o(0);
  ASSERT_TRUE(body.offsets.o.at(dragged + Vec3i(7, 3, 1), o));
  EXPECT_LT((o - Vec3f(-7, -3, -1)).length(), 1e-4f);
}

/// The judge is brute force: all cells solved for all nodes.
TEST(PropertyTissueOverAir, InAFoldedBodyNoNodeShowsAirThatTissueCovers) {
  std::mt19937 random(8);
  const Vec3i dims(20, 20, 20);
  const BrickTopology ball = topology_where({3, 3, 3}, {16, 16, 16}, [](const Vec3i& v) {
    return (Vec3d(v) - Vec3d(9.5)).length() < 6.5;
  });
  const Body body(dims, ball, [&](const Vec3i&) { return random_vector(random, 1.2f); });
  const VectorBricks& u = body.displacement.u;
  std::map<Voxel, std::vector<Vec3d>> tissue;  // places that came to a node
  for_each_slot(u.topology, [&](const Vec3i& cell, std::size_t) {
    CellCorners corners;
    for (int n = 0; n < 8; ++n) {
      const Vec3i step(n >> 2, n >> 1 & 1, n & 1);
      Vec3f moved;
      if (!ball.is_active(cell + step) || !u.at(cell + step, moved)) return;
      for (int a = 0; a < 3; ++a) corners.p[a][n] = step[a] + double(moved[a]);
    }
    for (int n = 0; n < 125; ++n) {
      const Vec3i node(n / 25 - 2, n / 5 % 5 - 2, n % 5 - 2);
      Vec3d local;
      const auto outcome =
          DeformedCell(corners, true).solve_by_bisection(Vec3d(node), 1e-4, 20, local);
      if (outcome != DeformedCell::Outcome::inside) continue;
      tissue[key(cell + node)].push_back(Vec3d(cell) + local);
    }
  });
  int folded = 0;
  std::int64_t overlapped = 0;
  for (const auto& [node, places] : tissue) {
    const Vec3i at(std::get<0>(node), std::get<1>(node), std::get<2>(node));
    Vec3f o;
    ASSERT_TRUE(body.offsets.o.at(at, o));
    const Vec3d shown = Vec3d(at) + Vec3d(o);
    const auto distance = [&](const Vec3d& place) { return (place - shown).length(); };
    double nearest = 1e9, farthest = 0;
    for (const Vec3d& place : places) {
      nearest = std::min(nearest, distance(place));
      farthest = std::max(farthest, distance(place));
    }
    EXPECT_LT(nearest, 1e-3) << "air is shown";
    folded += places.size() > 1;
    if (farthest > kSamePlace) {
      ++overlapped;
      EXPECT_TRUE(body.offsets.overlaps.is_active(at));
    }
  }
  EXPECT_GT(tissue.size(), 500u);
  EXPECT_GT(folded, 50);
  EXPECT_GT(overlapped, 10);
  EXPECT_GE(body.offsets.certificate.overlapped_voxels, overlapped);
  EXPECT_GT(body.hidden(), 0);
}

TEST(PropertyTissueOverAir, AfterLocalChangesOverlapsAreThoseOfAFullInversion) {
  std::mt19937 random(5);
  Slabs slabs(0);
  InvertParams params;
  params.material = &slabs.elements;
  IncrementalInversion inversion(slabs.displacement, params);
  std::vector<std::int32_t> all;
  for (std::size_t b = 0; b < slabs.displacement.u.topology.brick_count(); ++b) {
    all.push_back(std::int32_t(b));
  }
  for (const float lowered : {8.0f, 2.0f, 11.5f, 6.0f}) {
    slabs.displacement.u = Slabs(lowered).displacement.u;
    inversion.update(slabs.displacement, all);
    const OffsetField full = invert(slabs.displacement, params);
    expect_equal(inversion.field(slabs.displacement), full);
    EXPECT_TRUE(inversion.field(slabs.displacement).overlaps == full.overlaps);
    EXPECT_EQ(full.overlaps.empty(), lowered <= 6);
  }
}

TEST(PropertyTissueOverAir, SamplesThatSolveForThemselvesFindTheTissue) {
  for (const Slabs::Moved moved : {Slabs::Moved::upper, Slabs::Moved::lower}) {
    for (const float by : {3.0f, 5.0f, 6.0f, 18.0f}) {
      const Slabs slabs(by, moved);
      const ForwardOffsets offsets(slabs.displacement, &slabs.elements);
      int lost = 0;
      for_each_slot(slabs.elements, [&](const Vec3i& v, std::size_t) {
        Vec3f u(0);
        slabs.displacement.u.at(v, u);
        const Vec3i at = v + Vec3i(u);
        const std::int32_t b = offsets.bricks().find(at);
        if (b < 0) return;  // nothing moves there
        // Samples as a ray does that comes through the air above.
        PointwiseOffsets::Sample found;
        const std::int32_t above = offsets.bricks().find(at + Vec3i(0, 0, 2));
        if (above >= 0) offsets.sample(std::size_t(above), Vec3d(at) + Vec3d(0, 0, 2), found);
        const bool is_found = offsets.sample(std::size_t(b), Vec3d(at), found);
        lost += !is_found || (found.offset + Vec3d(u)).length() > 1e-3;
      });
      EXPECT_EQ(lost, 0) << by;
    }
  }
}

TEST(PropertyTissueOverAir, LandmarksGoBackToTheTissueTheyCameFrom) {
  for (const float by : {3.0f, 5.0f, 6.0f, 18.0f}) {
    const Slabs slabs(by);
    const LinkCuts no_cuts;
    const auto back = motion_to_rest(slabs.displacement, {slabs.elements, no_cuts}, slabs.offsets);
    for (const Vec3d& X : {Vec3d(5, 6, 16), Vec3d(5.3, 6.2, 16.1), Vec3d(8, 8, 21)}) {
      const MovedPoint found = back->move(X - Vec3d(0, 0, by));
      EXPECT_LT((found.to_lps_mm - X).length(), 1e-4) << by << " at " << X;
      EXPECT_EQ(found.kind, PlaceKind::inside);
    }
    for (const Vec3d& X : {Vec3d(5, 6, 4), Vec3d(5.3, 6.2, 8.9)}) {
      EXPECT_LT((back->move(X).to_lps_mm - X).length(), 1e-4) << by << " at " << X;
    }
  }
}

TEST(PropertyTissueOverAir, LandmarksInOverlapsAreNamed) {
  const Slabs half(9);  // 16 to 21 come to 7 to 12
  const LinkCuts no_cuts;
  const auto back = motion_to_rest(half.displacement, {half.elements, no_cuts}, half.offsets);
  const MovedPoint both = back->move({5.4, 6.2, 8.3});
  EXPECT_EQ(both.kind, PlaceKind::folded);
  EXPECT_LT((both.to_lps_mm - Vec3d(5.4, 6.2, 8.3)).length(), 1e-4) << "the shortest way";
  EXPECT_EQ(back->move({5.4, 6.2, 4.8}).kind, PlaceKind::inside);
  EXPECT_EQ(back->move({5.4, 6.2, 11.8}).kind, PlaceKind::inside);
}

TEST(PropertyTissueOverAir, LandmarksBetweenNodesFindTissueAndOverlapsThinnerThanAVoxel) {
  const Slabs slabs(6.3f);  // the lower one ends at 9.5, the upper one begins at 9.2
  ASSERT_EQ(slabs.offsets.certificate.overlapped_voxels, 0);
  const LinkCuts no_cuts;
  const auto back = motion_to_rest(slabs.displacement, {slabs.elements, no_cuts}, slabs.offsets);
  for (double z = 9.01; z < 10; z += 0.06) {
    const bool is_both = z > 9.2 && z < 9.5;
    const MovedPoint found = back->move({5.4, 6.2, z});
    EXPECT_EQ(found.kind, is_both ? PlaceKind::folded : PlaceKind::inside) << z;
    EXPECT_NEAR(found.to_lps_mm.z, z < 9.5 ? z : z + 6.3, 1e-4) << z;
  }
}

TEST(PropertyTissueOverAir, LandmarksBesideASliceFindItsTissue) {
  const Body slabs(
      {14, 26, 1},
      unite(box_topology({2, 4, 0}, {11, 9, 0}), box_topology({2, 16, 0}, {11, 21, 0})),
      [](const Vec3i& v) { return Vec3f(0, v.y < 13 ? 0.f : -6.f, 0); });
  const LinkCuts no_cuts;
  const auto back = motion_to_rest(slabs.displacement, {slabs.elements, no_cuts}, slabs.offsets);
  for (const double z : {0.0, 0.4, 0.7, -0.8}) {
    EXPECT_LT((back->move({5.4, 9.7, z}).to_lps_mm - Vec3d(5.4, 15.7, z)).length(), 1e-4) << z;
  }
}
