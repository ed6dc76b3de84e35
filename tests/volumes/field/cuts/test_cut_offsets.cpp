// Bodies whose cuts have opened (cut_offsets.h): every place is known.
#include <gtest/gtest.h>

#include "tests/support/sanitized.h"
#include "tests/volumes/field/offset_fixtures.h"
#include "volumes/base/parallel.h"
#include "volumes/field/cuts/cut_inversion.h"
#include "volumes/field/cuts/cut_offsets.h"
#include "volumes/field/dense/resample.h"
#include "volumes/field/offset_field.h"
#include "volumes/grid/density_grid.h"

using namespace supple;
using namespace supple::test;

namespace {

using VoxelLaw = std::function<bool(const Vec3i&, int)>;

/// Cuts the links (low end, axis) between elements that the law names.
LinkCuts cuts_where(const BrickTopology& elements, const VoxelLaw& is_cut,
                    LinkCuts::Place place = 0) {
  LinkCuts cuts;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for_each_active(elements.mask(b), [&](int offset) {
      const Vec3i low = elements.origin(b) + brick_local(offset);
      for (int axis = 0; axis < 3; ++axis) {
        Vec3i high = low;
        ++high[axis];
        if (elements.is_active(high) && is_cut(low, axis)) cuts.cut(b, offset, axis, place);
      }
    });
  }
  return cuts;
}

/// A block cut in two at x = 13.5.
struct CutBlock {
  static constexpr double kFace = 13.5;
  BrickTopology elements = box_topology({4, 4, 4}, {23, 19, 19});
  LinkCuts cuts =
      cuts_where(elements, [](const Vec3i& low, int axis) { return axis == 0 && low.x == 13; });
  CutElements body{elements, cuts};

  static bool is_left(const Vec3d& X) { return X.x < kFace; }
  /// The halves moved by u, each its own, off the border of the grid.
  Displacement moved(const std::function<Vec3d(bool is_left, const Vec3d& X)>& u) const {
    Displacement displacement = displacement_on(
        elements, [&](const Vec3i& v) { return Vec3f(u(is_left(Vec3d(v)), Vec3d(v))); });
    displacement.geometry = unit_geometry({25, 21, 21});
    return displacement;
  }
  OffsetField opened_by(double d) const {
    return invert_cut(moved([d](bool left, const Vec3d&) { return Vec3d(left ? -d : d, 0, 0); }),
                      body);
  }
};

bool is_in_block(const Vec3d& X, double margin) {
  return X.x > 4 + margin && X.x < 23 - margin && X.y > 4 + margin && X.y < 19 - margin &&
         X.z > 4 + margin && X.z < 19 - margin;
}

bool equal(const VectorBricks& a, const VectorBricks& b) {
  return a.topology == b.topology && to_map(a) == to_map(b);
}

}  // namespace

TEST(PropertyCutOffsets, AnExportOnTheSourceGridReadsWhatASampleReads) {
  const CutBlock block;
  for (const double d : {-0.7, 0.3, 2.25}) {
    const OffsetField field = block.opened_by(d);
    ASSERT_NE(field.split, nullptr);
    const Vec3i dims = field.geometry.dims();
    const auto slices = dense_offsets(field, block.elements, field.geometry, VoidMode::outside);
    const IndexBox source_box{Vec3i(0), dims - Vec3i(1)};
    std::vector<Vec3f> slice(std::size_t(dims.x) * dims.y);
    int read = 0;
    for (int k = 0; k < dims.z; ++k) {
      slices(k, slice.data());
      for (int n = 0; n < dims.x * dims.y; ++n) {
        const Vec3d x(Vec3i(n % dims.x, n / dims.x, k));
        Vec3d o;
        const bool found = field.sample(x, o);
        const Vec3d place = x + field.geometry.index_vector_from_world(Vec3d(slice[n]));
        if (found) {
          ASSERT_LT((place - x - o).length(), 1e-5) << x;
        } else {
          ASSERT_FALSE(source_box.contains(Vec3i(place))) << x;
        }
        read += found;
      }
    }
    EXPECT_GT(read, 3000);
  }
}

TEST(PropertyCutOffsets, HalvesMovedApartReadTheirOwnSideUpToTheFaceAndNothingBetween) {
  const CutBlock block;
  for (const double d : {0.3, 2.25, 11.0}) {
    const OffsetField field = block.opened_by(d);
    ASSERT_NE(field.split, nullptr);
    EXPECT_EQ(field.certificate.torn_cells, 15 * 15);
    std::mt19937 random(5);
    int read = 0, in_gap = 0;
    for (int n = 0; n < 20000; ++n) {
      const Vec3d x = random_place(random, 0, 28) * Vec3d(1.6, 1, 1) - Vec3d(8, 0, 0);
      const Vec3d left = x + Vec3d(d, 0, 0), right = x - Vec3d(d, 0, 0);
      if (std::abs(left.x - 13.5) < 1e-4 || std::abs(right.x - 13.5) < 1e-4) continue;
      const bool of_left = is_in_block(left, 1) && left.x < 13.5;
      const bool of_right = is_in_block(right, 1) && right.x > 13.5;
      Vec3d o;
      const bool found = field.sample(x, o);
      if (of_left || of_right) {
        ASSERT_TRUE(found) << x;
        EXPECT_LT((o - Vec3d(of_left ? d : -d, 0, 0)).length(), 1e-6) << x;
        ++read;
      } else if (!is_in_block(left, -1e-3) && !is_in_block(right, -1e-3)) {
        EXPECT_FALSE(found) << x;
      } else if (left.x > 13.5 && right.x < 13.5) {
        EXPECT_FALSE(found) << x << " lies in the gap";
        ++in_gap;
      }
    }
    EXPECT_GT(read, 1200);
    EXPECT_GT(in_gap, d > 1 ? 300 : 30);
  }
}

TEST(PropertyCutOffsets, SidesThatTurnAndStretchAreInvertedExactlyUpToTheFace) {
  const CutBlock block;
  const auto linear = [](bool left, const Vec3d& d) {
    return left ? Vec3d(0.1 * d.x + 0.2 * d.y, -0.15 * d.x, 0.05 * d.z)
                : Vec3d(-0.1 * d.x, 0.25 * d.x + 0.05 * d.y, 0.1 * d.y);
  };
  const Vec3d pivot(13.5, 4, 11);
  const OffsetField field = invert_cut(block.moved([&](bool left, const Vec3d& X) {
    return linear(left, X - pivot) + Vec3d(left ? -1.5 : 1.5, 0, 0);
  }),
                                       block.body);
  ASSERT_NE(field.split, nullptr);
  EXPECT_EQ(field.certificate.overlapped_voxels, 0);
  std::mt19937 random(6);
  int beside_face = 0;
  for (int n = 0; n < 20000; ++n) {
    Vec3d X = random_place(random, 4.01, 18.99);
    X.x = 12 + 3 * (X.x - 4) / 15;
    if (std::abs(X.x - 13.5) < 1e-3) continue;
    const bool left = X.x < 13.5;
    const Vec3d x = X + linear(left, X - pivot) + Vec3d(left ? -1.5 : 1.5, 0, 0);
    Vec3d o;
    ASSERT_TRUE(field.sample(x, o)) << X;
    EXPECT_LT((x + o - X).length(), 1e-4) << X;
    beside_face += std::abs(X.x - 13.5) < 0.5;
  }
  EXPECT_GT(beside_face, 1000);
}

TEST(PropertyCutOffsets, CellsThatMayBeInterpolatedGiveTheOffsetsOfTheirSide) {
  const CutBlock block;
  const OffsetField field = invert_cut(block.moved([](bool left, const Vec3d& X) {
    const Vec3d d = X - Vec3d(13.5, 4, 11);
    return left ? Vec3d(0.1 * d.x + 0.2 * d.y - 1.5, -0.15 * d.x, 0.05 * d.z)
                : Vec3d(1.5 - 0.1 * d.x, 0.25 * d.x + 0.05 * d.y, 0.1 * d.y);
  }),
                                       block.body);
  ASSERT_NE(field.split, nullptr);
  std::mt19937 random(7);
  int cells = 0, beside_face = 0;
  const BrickTopology& bricks = field.split->bricks();
  for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
    for_each_active(*field.split->interpolated(b), [&](int offset) {
      const Vec3d x = Vec3d(bricks.origin(b) + brick_local(offset)) + random_place(random, 0, 1);
      Vec3d between, own;
      ASSERT_TRUE(field.o.sample(x, between)) << x;
      ASSERT_TRUE(field.sample(x, own)) << x;  // of its side, exactly
      EXPECT_LT((between - own).length(), 1e-3) << x;
      ++cells;
      beside_face += std::abs((x + own).x - CutBlock::kFace) < 2.5;
    });
  }
  EXPECT_GT(cells, 1500);
  EXPECT_GT(beside_face, 200);
}

TEST(PropertyCutOffsets, NoPlaceReadsTissueFromBeyondTheFaceOfItsSide) {
  // An oblique cut, whose links are stairs; the sides keep their volume.
  const BrickTopology elements = box_topology({2, 2, 2}, {25, 21, 13});
  const auto is_left = [](const Vec3i& v) { return v.x + 0.5 * v.y < 17.3; };
  const LinkCuts cuts = cuts_where(elements, [&](const Vec3i& low, int axis) {
    Vec3i high = low;
    ++high[axis];
    return is_left(low) != is_left(high);
  });
  Displacement u = displacement_on(
      elements, [&](const Vec3i& v) { return is_left(v) ? Vec3f(-2, -1, 0) : Vec3f(2, 1, 0); });
  u.geometry = unit_geometry({27, 23, 15});
  const OffsetField field = invert_cut(u, {elements, cuts});
  ASSERT_NE(field.split, nullptr);
  double volume = 0, expected = 23 * 19 * 11;
  constexpr double kStep = 0.25;
  for (double px = -3.9; px < 32; px += kStep) {
    for (double py = -1.9; py < 26; py += kStep) {
      for (double pz = 1.6; pz < 14; pz += 2 * kStep) {
        Vec3d o;
        if (!field.sample({px, py, pz}, o)) continue;
        volume += kStep * kStep * 2 * kStep;
        const Vec3d X = Vec3d(px, py, pz) + o;
        const double beyond = (X.x + 0.5 * X.y - 17.3) / std::sqrt(1.25);
        EXPECT_LT(o.x > 0 ? beyond : -beyond, 0.75) << X;
      }
    }
  }
  EXPECT_NEAR(volume, expected, 0.02 * expected);
}

TEST(PropertyCutOffsets, WithoutAnOpenCutEverythingIsWhatInvertGives) {
  const CutBlock block;
  const auto bend = [](const Vec3d& X) { return Vec3d(0.2 * X.y, 0.01 * X.x * X.z, -0.1 * X.x); };
  const Displacement smooth = block.moved([&](bool, const Vec3d& X) { return bend(X); });
  const OffsetField plain = invert(smooth);
  const LinkCuts none;
  for (const CutElements& body : {block.body, CutElements{block.elements, none}}) {
    const OffsetField field = invert_cut(smooth, body);
    EXPECT_EQ(field.split, nullptr);
    EXPECT_TRUE(equal(field.o, plain.o));
    EXPECT_EQ(field.certificate.residual_max, plain.certificate.residual_max);
    EXPECT_EQ(field.certificate.torn_cells, 0);
  }
}

TEST(PropertyCutOffsets, BricksAwayFromTheCutKeepTheirBits) {
  const BrickTopology elements = box_topology({0, 0, 0}, {63, 15, 15});
  const LinkCuts cuts =
      cuts_where(elements, [](const Vec3i& low, int axis) { return axis == 0 && low.x == 31; });
  std::mt19937 random(3);
  const Displacement u = displacement_on(elements, [&](const Vec3i& v) {
    return random_vector(random, 0.12f) + Vec3f(v.x < 32 ? -1.3f : 1.3f, 0, 0);
  });
  const OffsetField plain = invert(u), field = invert_cut(u, {elements, cuts});
  ASSERT_NE(field.split, nullptr);
  int compared = 0;
  for_each_slot(field.o.topology, [&](const Vec3i& v, std::size_t slot) {
    if (field.split->bricks().is_active(v)) return;
    Vec3f other;
    ASSERT_TRUE(plain.o.at(v, other));
    EXPECT_EQ(field.o.vectors.at(slot), other);
    ++compared;
  });
  EXPECT_GT(compared, 5000);
  EXPECT_LT(field.split->bricks().brick_count(), 40u);
}

TEST(PropertyCutOffsets, AnIncisionOpensFromItsEndAndOnlyThere) {
  // Cut from y = 11.5 up; below, the tissue holds. The opening grows with height.
  const BrickTopology elements = box_topology({4, 4, 4}, {35, 23, 15});
  const LinkCuts cuts = cuts_where(
      elements, [](const Vec3i& low, int axis) { return axis == 0 && low.x == 19 && low.y > 11; });
  const auto opening = [](double y) { return 0.4 * std::max(0.0, y - 11.5); };
  const OffsetField field = invert_cut(displacement_on(elements,
                                                       [&](const Vec3i& v) {
                                                         const float d = float(opening(v.y));
                                                         return Vec3f(v.x < 20 ? -d : d, 0, 0);
                                                       }),
                                       {elements, cuts});
  ASSERT_NE(field.split, nullptr);
  EXPECT_EQ(field.certificate.overlapped_voxels, 0);
  for (double y = 5; y < 22.9; y += 0.37) {
    for (double x = 12; x < 27; x += 0.21) {
      Vec3d o;
      const bool found = field.sample({x, y, 9.3}, o);
      const double from_face = std::abs(x - 19.5) - opening(y);
      if (y < 11 || from_face > 0.05) {
        EXPECT_TRUE(found) << x << " " << y;
      } else if (y > 12 && from_face < -0.05) {
        EXPECT_FALSE(found) << x << " " << y;
      }
      if (found && y > 12) {
        EXPECT_GT(o.x * (19.5 - x), 0) << x << " " << y;
      }
    }
  }
}

/// Around the end of a cut a cell with several sides, cells beside it and what is carried on beyond
/// a side meet in one place; lips are open, closed and through each other.
TEST(PropertyCutOffsets, TheFastWaysToAPieceFindWhatAllPiecesTell) {
  const BrickTopology elements = box_topology({4, 4, 4}, {30, 23, 15});
  // Oblique, from y = 11.5 up.
  const auto is_left = [](const Vec3i& v) { return v.x + 0.6 * v.z < 21.1 + 0.3 * v.y - 4; };
  const LinkCuts cuts = cuts_where(elements, [&](const Vec3i& low, int axis) {
    Vec3i high = low;
    ++high[axis];
    return low.y > 11 && is_left(low) != is_left(high);
  });
  std::mt19937 random(23);
  int found = 0, empty = 0;
  struct Case {
    double slope, from, bend;  // without bend the sides move alike at the end of the cut
  };
  for (const Case& at :
       {Case{0.4, 11.5, 1}, Case{0.1, 11.5, 1}, Case{0.03, 11.5, 1}, Case{-0.1, 11.5, 1},
        Case{0.4, 12, 0}, Case{0.1, 12, 0}, Case{-0.2, 12, 0}}) {
    const Displacement u = displacement_on(elements, [&](const Vec3i& v) {
      const double opening = at.slope * std::max(0.0, v.y - at.from);
      const Vec3d bend(0, 0.4 * std::sin(0.5 * v.x), 0.3 * std::cos(0.4 * v.y));
      return Vec3f(bend * at.bend + Vec3d(is_left(v) ? -opening : opening, 0, 0));
    });
    const Vec3i dims = u.geometry.dims();
    const CutBody cut(u.u, elements, cuts, dims);
    const BrickList all = all_bricks(cut.cells());
    TornCells torn(cut.cells());
    torn.follow(u.u, cut, all, {}, kClosedCut);
    CutFaces faces(cut.cells(), u.geometry, kClosedCut);
    faces.follow(torn, cut, all);
    CutInversion inversion(cut.cells(), elements, dims);
    inversion.follow(u.u, torn, faces, {all_moved(cut.cells()), all, all});
    const OffsetField whole = invert({u.geometry, {inversion.whole(), u.u.vectors}});
    inversion.split(u.u, torn, faces, finder_of(whole.o), {}, nullptr);
    for (const auto& split : inversion.bricks()) {
      const CutBrick& brick = split->cut;
      int guess = -1;
      const int places = brick.pieces().empty() ? 0 : cases(2000);
      for (int n = 0; n < places; ++n) {
        Vec3d x = Vec3d(brick.origin()) + random_place(random, 0, 8);
        const CutPiece& near = brick.pieces()[random() % brick.pieces().size()];
        const Vec3d in_it = Vec3d(near.cell) + random_place(random, 0, 1) + Vec3d(near.u[n % 8]);
        if (!near.is_whole && floor_voxel(in_it / 8.0) * 8 == brick.origin()) x = in_it;
        double shortest = HUGE_VAL;
        Content best = Content::air;
        for (const CutPiece& piece : brick.pieces()) {
          Vec3d X;
          if (!piece.source_of(x, X) || piece.content_at(X) < best) continue;
          if (piece.content_at(X) > best) shortest = HUGE_VAL;
          best = piece.content_at(X);
          shortest = std::min(shortest, (X - x).length());
        }
        Vec3d offset;
        const int piece = brick.find(x, dims, offset, guess);
        ASSERT_EQ(piece >= 0, shortest < HUGE_VAL) << at.slope << " " << x;
        if (piece < 0) {
          ++empty;
          continue;
        }
        guess = piece;
        ++found;
        ASSERT_NEAR(offset.length(), shortest, 1e-3) << at.slope << " " << x;
      }
    }
  }
  EXPECT_GT(found, 1000);
  EXPECT_GT(empty, 1000);
}

TEST(PropertyCutOffsets, SidesPushedThroughEachOtherAreCountedAndTheShortestOffsetWins) {
  const CutBlock block;
  const double d = -3.2;  // an overlap of 6.4 voxels
  const OffsetField field = invert_cut(
      block.moved([&](bool left, const Vec3d&) { return Vec3d(left ? -d : 0.5 * d, 0, 0); }),
      block.body);
  ASSERT_NE(field.split, nullptr);
  // Left now ends at 16.7, right begins at 11.9: nodes 12 to 16 of every row.
  EXPECT_EQ(field.certificate.overlapped_voxels, 5 * 16 * 16);
  for (double x = 8; x < 20; x += 0.17) {
    Vec3d o;
    ASSERT_TRUE(field.sample({x, 9.4, 12.1}, o)) << x;
    EXPECT_NEAR(o.x, x > 11.9 ? 1.6 : -3.2, 1e-6) << x;
  }
}

TEST(PropertyCutOffsets, TheShellGoesWithItsOwnSide) {
  const CutBlock block;
  const BrickTopology shell = dilate(block.elements, 2);
  for (const float by : {4.0f, 0.375f}) {
    const Displacement u =
        block.moved([by](bool left, const Vec3d&) { return Vec3d(left ? -by : by, 0, 0); });
    const Displacement extended = extend_past_cuts(u, shell, block.body);
    int checked = 0;
    for_each_slot(shell, [&](const Vec3i& v, std::size_t) {
      Vec3f value;
      ASSERT_TRUE(extended.u.at(v, value));
      EXPECT_EQ(value, Vec3f(v.x < 14 ? -by : by, 0, 0)) << v;
      ++checked;
    });
    EXPECT_EQ(checked, 24 * 20 * 20);
    const OffsetField field = invert_cut(extended, block.body);
    Vec3d o;
    EXPECT_FALSE(field.sample({13.5, 20.5, 10}, o));
    EXPECT_TRUE(field.sample({9.4, 20.5, 10}, o));
  }
}

TEST(PropertyCutOffsets, TheShellOverAShorterSideGoesWithThatSide) {
  // Air beside the wall of the longer side is next to it and two voxels from its own side.
  const BrickTopology elements =
      subtract(box_topology({4, 4, 4}, {23, 19, 19}), box_topology({14, 17, 4}, {23, 19, 19}));
  const LinkCuts cuts = cuts_where(
      elements, [](const Vec3i& low, int axis) { return axis == 0 && low.x == 13; },
      LinkCuts::place_of(0.5));
  const Displacement u = displacement_on(
      elements, [](const Vec3i& v) { return Vec3f(v.x < 14 ? -4.0f : 4.0f, 0, 0); });
  const Displacement extended = extend_past_cuts(u, dilate(elements, 2), {elements, cuts});
  int checked = 0;
  for (int y = 17; y <= 18; ++y) {
    for (int x = 14; x <= 16; ++x) {
      for (int z = 6; z <= 17; ++z, ++checked) {
        Vec3f value(0);
        ASSERT_TRUE(extended.u.at({x, y, z}, value));
        EXPECT_EQ(value, Vec3f(4, 0, 0)) << Vec3i(x, y, z);
      }
    }
  }
  EXPECT_EQ(checked, 72);
}

TEST(PropertyCutOffsets, NoTissueIsStretchedOverASlitOfAirThroughWhichACutGoes) {
  // One voxel wide and, in its middle, farther from every cut link than tissue is looked for.
  const CutBlock block;
  const BrickTopology slit = box_topology({13, 6, 6}, {13, 17, 17});
  const BrickTopology elements = subtract(block.elements, slit);
  const LinkCuts cuts =
      cuts_where(elements, [](const Vec3i& low, int axis) { return axis == 0 && low.x == 13; });
  const double d = 6.2;
  const Displacement u = displacement_on(
      elements, [&](const Vec3i& v) { return Vec3f(v.x < 14 ? float(-d) : float(d), 0, 0); });
  const CutElements body{elements, cuts};
  const OffsetField field = invert_cut(extend_past_cuts(u, dilate(elements, 2), body), body);
  for (double y = 4.1; y < 19; y += 0.6) {
    for (double z = 4.3; z < 19; z += 0.6) {
      for (double x = 13.5 - d - 1.9; x < 13.5 + d + 2; x += 0.43) {
        Vec3d o;
        const bool in_gap = std::abs(x - 13.5) < d;
        ASSERT_EQ(field.sample({x, y, z}, o), !in_gap) << Vec3d(x, y, z);
        if (in_gap) continue;
        ASSERT_NEAR(o.x, x < 13.5 ? d : -d, 1e-6) << Vec3d(x, y, z);
      }
    }
  }
}

TEST(PropertyCutOffsets, ASlitInTissueThatStretchesIsNotTorn) {
  // Its walls part by more than a voxel, but tissue leads round it; the cut stays closed.
  const CutBlock block;
  const BrickTopology elements = subtract(block.elements, box_topology({21, 8, 8}, {21, 12, 12}));
  const LinkCuts cuts =
      cuts_where(elements, [](const Vec3i& low, int axis) { return axis == 0 && low.x == 13; });
  const CutElements body{elements, cuts};
  const Displacement u = displacement_on(elements, [](const Vec3i& v) {
    return Vec3f(0.75f * float(std::clamp(v.x - 20, 0, 2)), 0, 0);
  });
  const OffsetField field = invert_cut(extend_past_cuts(u, dilate(elements, 2), body), body);
  EXPECT_EQ(field.certificate.torn_cells, 0);
  EXPECT_EQ(field.split, nullptr);
}

TEST(PropertyCutOffsets, AnOpenedSliceOfOneVoxelHasItsGap) {
  const BrickTopology elements = box_topology({4, 4, 0}, {23, 19, 0});
  const LinkCuts cuts =
      cuts_where(elements, [](const Vec3i& low, int axis) { return axis == 0 && low.x == 13; });
  const OffsetField field =
      invert_cut(displacement_on(
                     elements, [](const Vec3i& v) { return Vec3f(v.x < 14 ? -2.0f : 2.5f, 0, 0); }),
                 {elements, cuts});
  for (double x = 3; x < 25; x += 0.3) {
    Vec3d o;
    const bool in_gap = x > 11.5 && x < 16;
    EXPECT_EQ(field.sample({x, 10.25, 0}, o), !in_gap) << x;
  }
}

TEST(PropertyCutOffsets, AResampledVolumeIsVoidInTheGapAndUntouchedBeside) {
  const CutBlock block;
  const Displacement u =
      block.moved([](bool left, const Vec3d&) { return Vec3d(left ? -2 : 2, 0, 0); });
  const OffsetField field = invert_cut(u, block.body);
  std::vector<float> values(block.elements.brick_count() * kBrickVoxels);
  for_each_slot(block.elements,
                [&](const Vec3i& v, std::size_t slot) { values[slot] = float(100 + v.x); });
  const DensityGrid density = make_density_grid(block.elements, values, 0);
  const Geometry grid = unit_geometry({28, 24, 24});
  std::vector<float> slice(28 * 24);
  dense_resampled(field, density, grid, -1)(10, slice.data());
  for (int x = 2; x <= 25; ++x) {
    const float expected = x <= 11 ? float(102 + x) : x >= 16 ? float(98 + x) : -1.0f;
    EXPECT_EQ(slice[std::size_t(10 * 28 + x)], expected) << x;
  }
}

TEST(PropertyCutOffsets, TheNumberOfThreadsDoesNotMatter) {
  const CutBlock block;
  std::mt19937 random(8);
  const Displacement u = block.moved([&](bool left, const Vec3d&) {
    return Vec3d(random_vector(random, 0.14f)) + Vec3d(left ? -1 : 0.7, 0, 0);
  });
  const OffsetField many = on_threads(5, [&] { return invert_cut(u, block.body); });
  const OffsetField single = on_threads(1, [&] { return invert_cut(u, block.body); });
  EXPECT_TRUE(equal(many.o, single.o));
  EXPECT_EQ(many.certificate.overlapped_voxels, single.certificate.overlapped_voxels);
  for (int n = 0; n < 3000; ++n) {
    const Vec3d x = random_place(random, 2, 26);
    Vec3d a(0), b(0);
    ASSERT_EQ(many.sample(x, a), single.sample(x, b));
    EXPECT_EQ(a, b);
  }
}

TEST(UnitCutOffsets, AFaceKnowsItsNormalAndDepthOnEitherSide) {
  const CutBlock block;
  const OffsetField field = block.opened_by(2);
  for (const double depth : {0.2, 1.0, 2.7}) {
    for (const double side : {-1.0, 1.0}) {
      const Vec3d x(13.5 + side * (2 + depth), 10.3, 11.6);
      const std::int32_t b = field.split->bricks().find({int(x.x), int(x.y), int(x.z)});
      ASSERT_GE(b, 0);
      SplitOffsets::Sample found;
      ASSERT_TRUE(field.split->sample(std::size_t(b), x, found));
      EXPECT_NEAR(field.split->depth_mm(found.piece, x), depth, 1e-6);
      EXPECT_LT((field.split->face_normal(found.piece, x) - Vec3d(side, 0, 0)).length(), 1e-6);
      const Vec3d gradient(1, 2, 3);
      EXPECT_LT(
          (field.split->pull_back(found.piece, x, x + found.offset, gradient) - gradient).length(),
          1e-6);
    }
  }
}

TEST(PropertyCutOffsets, GradientsAndFacesOfBentSidesAreThoseOfDifferences) {
  const CutBlock block;
  std::mt19937 random(21);
  const Displacement u = block.moved([&](bool left, const Vec3d& X) {
    const Vec3d bend(0.06 * std::sin(X.y / 3), 0.5 * std::cos(X.z / 4), 0.02 * X.x);
    return bend * (left ? 1 : -2) + Vec3d(left ? -1.5 : 1.5, 0, 0);
  });
  const OffsetField field = invert_cut(u, block.body);
  const SplitOffsets& split = *field.split;
  int compared = 0, faces = 0;
  for (int n = 0; n < 4000; ++n) {
    const Vec3d x = random_place(random, 8, 20);
    const std::int32_t b = split.bricks().find({int(x.x), int(x.y), int(x.z)});
    SplitOffsets::Sample found;
    if (b < 0 || !split.sample(std::size_t(b), x, found)) continue;
    const Vec3d gradient(random_vector(random, 1)), y = x + found.offset;
    const Vec3d differences = split.SplitOffsets::pull_back(found.piece, x, y, gradient);
    ASSERT_LT((split.pull_back(found.piece, x, y, gradient) - differences).length(), 2e-3);
    ++compared;
    Vec3d normal;
    double depth;
    if (!split.face(found.piece, x, y, normal, depth)) continue;
    EXPECT_NEAR(split.depth_mm(found.piece, x), depth, 1e-3);
    // The planes of neighbouring points take over from each other with little jumps.
    const Vec3d by_steps = split.SplitOffsets::face_normal(found.piece, x);
    if (by_steps != Vec3d(0) && (normal - by_steps).length() < 0.1) ++faces;
  }
  EXPECT_GT(compared, 1000);
  EXPECT_GT(faces, compared / 3);
}
