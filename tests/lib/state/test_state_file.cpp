#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/random_state.h"
#include "tests/support/sanitized.h"
#include "tests/support/temporary_folder.h"
#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/field/procedural.h"

using namespace supple;
using namespace supple::test;

TEST(PropertyState, AWrittenStateReadsBackBitForBit) {
  const TemporaryFolder folder;
  std::int64_t elements = 0, cuts = 0;
  for (int seed = 0; seed < cases(150); ++seed) {
    const State state = random_state(unsigned(seed));
    write_state(folder / "a.vdb", state);
    ASSERT_TRUE(is_state_file(folder / "a.vdb"));
    ASSERT_TRUE(same_state(read_state(folder / "a.vdb"), state)) << "seed " << seed;
    elements += state.elements.active_count();
    cuts += state.cuts.count();
  }
  EXPECT_GT(elements, cases(10000));
  EXPECT_GT(cuts, cases(1000));
  EXPECT_EQ(folder.entries().size(), 1u);
}

TEST(PropertyState, EqualStatesAreEqualFilesWhateverTheThreadCount) {
  const TemporaryFolder folder;
  for (int seed = 0; seed < cases(20); ++seed) {
    const State state = random_state(unsigned(seed));
    on_threads(1, [&] { write_state(folder / "a.vdb", state); });
    on_threads(4, [&] { write_state(folder / "b.vdb", read_state(folder / "a.vdb")); });
    ASSERT_EQ(read_text(folder / "a.vdb"), read_text(folder / "b.vdb")) << "seed " << seed;
  }
}

/// Leaves are decoded 64 at a time (leaf_ranges.h).
TEST(PropertyState, AStateOfManyBricksReadsTheSameOnAnyNumberOfThreads) {
  const TemporaryFolder folder;
  int large = 0;
  for (int seed = 0; large < cases(10); ++seed) {
    const State state = random_state(unsigned(seed), 56);
    if (state.elements.brick_count() < 130) continue;
    ++large;
    write_state(folder / "a.vdb", state);
    for (const int threads : {1, 4}) {
      const State read = on_threads(threads, [&] { return read_state(folder / "a.vdb"); });
      ASSERT_TRUE(same_state(read, state)) << "seed " << seed << ", threads " << threads;
    }
  }
}

TEST(PropertyState, AStateThatDiffersInOneBitIsAnotherFile) {
  const TemporaryFolder folder;
  State state = random_state(5);
  ASSERT_FALSE(state.elements.empty());
  state.q[1] = {};
  write_state(folder / "a.vdb", state);
  state.q[1].resize(state.elements.brick_count());
  int first = 0;
  while (!mask_test(state.elements.mask(0), first)) ++first;
  state.q[1].touch(0)[first] = 1;
  write_state(folder / "b.vdb", state);
  EXPECT_NE(read_text(folder / "a.vdb"), read_text(folder / "b.vdb"));
  EXPECT_TRUE(same_state(read_state(folder / "b.vdb"), state));
}

TEST(UnitState, ZerosEqualACoordinateThatNeverMoved) {
  const TemporaryFolder folder;
  State state = random_state(3);
  ASSERT_FALSE(state.elements.empty());
  state.q = {};
  write_state(folder / "a.vdb", state);
  state.q[2].resize(state.elements.brick_count());
  for (std::size_t b = 0; b < state.elements.brick_count(); ++b) state.q[2].touch(b);
  write_state(folder / "b.vdb", state);
  EXPECT_EQ(read_text(folder / "a.vdb"), read_text(folder / "b.vdb"));
  EXPECT_TRUE(read_state(folder / "b.vdb").q[2].empty());
}

TEST(UnitState, LinksCutInAnotherOrderGiveTheSameFileAndNoneGivesNoGrid) {
  const TemporaryFolder folder;
  State state;
  state.geometry = Geometry().with_dims({20, 2, 2});
  state.elements = bricks_where({20, 2, 2}, [](const Vec3i&) { return true; });
  state.density = make_density_grid(state.elements, std::vector<float>(3 * kBrickVoxels, 1.0f), 0);
  write_state(folder / "none.vdb", state);
  EXPECT_EQ(read_text(folder / "none.vdb").find("cut_links"), std::string::npos);
  const int last = brick_offset({7, 1, 0});
  EXPECT_TRUE(state.cuts.cut(1, last, 0));
  EXPECT_FALSE(state.cuts.cut(1, last, 0));
  EXPECT_TRUE(state.cuts.cut(0, 0, 2));
  EXPECT_EQ(state.cuts.count(), 2);
  write_state(folder / "a.vdb", state);
  LinkCuts reversed;
  reversed.cut(0, 0, 2);
  EXPECT_FALSE(reversed == state.cuts);
  reversed.cut(1, last, 0);
  EXPECT_TRUE(reversed == state.cuts);
  state.cuts = reversed;
  write_state(folder / "b.vdb", state);
  EXPECT_EQ(read_text(folder / "a.vdb"), read_text(folder / "b.vdb"));
}

TEST(UnitState, PlacesOfCutLinksAreKeptToAThousandth) {
  const TemporaryFolder folder;
  State state;
  state.geometry = Geometry().with_dims({8, 8, 8});
  state.elements = bricks_where({8, 8, 8}, [](const Vec3i&) { return true; });
  state.density = make_density_grid(state.elements, std::vector<float>(kBrickVoxels, 1.0f), 0);
  for (int n = 0; n < 7; ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      state.cuts.cut(0, brick_offset({n, n, n}), axis, LinkCuts::place_of((3 * n + axis) / 20.0));
    }
  }
  state.cuts.cut(0, brick_offset({0, 3, 4}), 1);
  write_state(folder / "places.vdb", state);
  const State read = read_state(folder / "places.vdb");
  EXPECT_TRUE(read.cuts == state.cuts);
  for (int n = 0; n < 7; ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      const LinkCuts::Place place = read.cuts.place(0, brick_offset({n, n, n}), axis);
      EXPECT_NEAR(LinkCuts::fraction_of(place), (3 * n + axis) / 20.0, 1e-3);
    }
  }
  EXPECT_EQ(read.cuts.place(0, brick_offset({0, 3, 4}), 1), 0);
  // The first of two surfaces through a link counts.
  LinkCuts twice = read.cuts;
  EXPECT_FALSE(twice.cut(0, 0, 0, LinkCuts::place_of(0.9)));
  EXPECT_TRUE(twice == read.cuts);
  EXPECT_FALSE(twice.cut(0, brick_offset({0, 3, 4}), 1, LinkCuts::place_of(0.9)));
  EXPECT_FALSE(twice == read.cuts);
}

TEST(UnitState, LabelsThatNoElementHasGiveNoGrid) {
  const TemporaryFolder folder;
  State state;
  state.geometry = Geometry().with_dims({20, 2, 2});
  state.elements = bricks_where({20, 2, 2}, [](const Vec3i&) { return true; });
  state.density = make_density_grid(state.elements, std::vector<float>(3 * kBrickVoxels, 1.0f), 0);
  write_state(folder / "none.vdb", state);
  EXPECT_EQ(read_text(folder / "none.vdb").find("label"), std::string::npos);
  state.labels.resize(3);
  state.labels.touch(1);
  write_state(folder / "zeros.vdb", state);
  EXPECT_EQ(read_text(folder / "none.vdb"), read_text(folder / "zeros.vdb"));
  state.labels.set(2 * kBrickVoxels, kMaxLabel);
  state.anchor_labels = {kMaxLabel};
  write_state(folder / "one.vdb", state);
  const State back = read_state(folder / "one.vdb");
  EXPECT_TRUE(same_state(back, state));
  EXPECT_EQ(back.labels.stored_bricks(), 1u);
}

TEST(UnitState, TheDisplacementIsTheFixedPointOffsetInVoxels) {
  State state;
  state.geometry = Geometry().with_dims({9, 1, 1});
  state.elements = bricks_where({9, 1, 1}, [](const Vec3i&) { return true; });
  state.q[1].resize(2);
  state.q[1].set(kBrickVoxels, 3 << (kFixedBits - 1));
  Vec3f u;
  ASSERT_TRUE(displacement_of(state).u.at({8, 0, 0}, u));
  EXPECT_EQ(u, Vec3f(0, 1.5f, 0));
  ASSERT_TRUE(displacement_of(state).u.at({7, 0, 0}, u));
  EXPECT_EQ(u, Vec3f(0));
}

TEST(PropertyState, TheExtendedDisplacementCoversElementsAndShell) {
  const auto ball = [](double radius) {
    return bricks_where({20, 20, 20}, [radius](const Vec3i& voxel) {
      return (Vec3d(voxel) - Vec3d(9.5)).length() < radius;
    });
  };
  State state;
  state.geometry = Geometry().with_dims({20, 20, 20});
  state.elements = ball(5);
  const BrickTopology shell = ball(7);
  state.density =
      make_density_grid(shell, std::vector<float>(shell.brick_count() * kBrickVoxels, 1.0f), 0);
  state.q[0].resize(state.elements.brick_count());
  for (std::size_t b = 0; b < state.elements.brick_count(); ++b) {
    for_each_active(state.elements.mask(b),
                    [&](int offset) { state.q[0].touch(b)[offset] = 1 << kFixedBits; });
  }
  const Displacement extended = extended_displacement_of(state);
  EXPECT_TRUE(extended.u.topology == shell);
  Vec3f u;
  ASSERT_TRUE(extended.u.at({3, 9, 9}, u));
  EXPECT_EQ(u, Vec3f(1, 0, 0));
}

TEST(UnitState, OffsetsForOtherProgramsDoNotChangeTheState) {
  const TemporaryFolder folder;
  const State state = random_state(11);
  const OffsetField offsets =
      sample_offsets(shear_warp({3, 3, 3}, 0.2), state.geometry, state.elements);
  write_state(folder / "a.vdb", state);
  write_state(folder / "b.vdb", state, offsets);
  EXPECT_GT(read_text(folder / "b.vdb").size(), read_text(folder / "a.vdb").size());
  EXPECT_TRUE(same_state(read_state(folder / "b.vdb"), state));
}

TEST(UnitState, GeometriesThatOpenVdbRefusesAreKept) {
  const TemporaryFolder folder;
  State state = random_state(12);
  for (const double scale : {1e-9, 1e9}) {
    state.geometry = Geometry(state.geometry.dims(), Vec3d(0.1, 1.0 / 3, -0.0),
                              {Vec3d(scale, 0, 0), {0.3 * scale, scale, 0}, {0, 0, -scale}});
    write_state(folder / "a.vdb", state);
    EXPECT_TRUE(same_state(read_state(folder / "a.vdb"), state)) << scale;
  }
}
