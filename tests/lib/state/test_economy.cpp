// Fields of a local drag: what they store does not grow with the tissue around it.
#include <gtest/gtest.h>

#include "lib/state/pose.h"
#include "lib/state/warp_jumps.h"
#include "tests/support/program.h"
#include "tests/support/random_state.h"
#include "tests/support/temporary_folder.h"
#include "volumes/field/dense/resample.h"
#include "volumes/io/volume_writer.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Tissue fills the box but for two voxels on every side; a lump of it has gone along j, in the
/// middle.
State dragged(int size) {
  State state;
  const Vec3i dims(size);
  state.geometry = {dims, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}}};
  const auto is_within = [=](const Vec3i& v, int border) {
    return std::min({v.x, v.y, v.z}) >= border && std::max({v.x, v.y, v.z}) < size - border;
  };
  state.elements = bricks_where(dims, [&](const Vec3i& v) { return is_within(v, 2); });
  state.density = fill_density_grid(
      bricks_where(dims, [](const Vec3i&) { return true; }),
      [](std::size_t, float* out) { std::fill_n(out, 512, 1.0F); }, 0);
  const Vec3i middle = dims / 2;
  BrickValues& along = state.q[1];
  along.resize(state.elements.brick_count());
  for (std::size_t b = 0; b < state.elements.brick_count(); ++b) {
    for_each_active(state.elements.mask(b), [&](int n) {
      const Vec3i from = state.elements.origin(b) + brick_local(n) - middle;
      const double left = 3 - Vec3d(from).length() / 3;
      if (left > 0) along.set(b * kBrickVoxels + std::size_t(n), std::int32_t(left * kFixedOne));
    });
  }
  return state;
}

/// True if a brick with that origin, or one that touches it, is stored in a coordinate.
bool is_near_motion(const State& state, const Vec3i& origin, int bricks) {
  for (int x = -bricks; x <= bricks; ++x) {
    for (int y = -bricks; y <= bricks; ++y) {
      for (int z = -bricks; z <= bricks; ++z) {
        const std::int32_t b = state.elements.find(origin + Vec3i(x, y, z) * kBrickDim);
        if (b >= 0 && state.q[1].brick(std::size_t(b)) != nullptr) return true;
      }
    }
  }
  return false;
}

/// Every stored brick of the field lies beside tissue that moved.
void expect_local(const State& state, const VectorBricks& field) {
  for (std::size_t b = 0; b < field.topology.brick_count(); ++b) {
    if (field.vectors.brick(b) == nullptr) continue;
    EXPECT_TRUE(is_near_motion(state, field.topology.origin(b), 1)) << field.topology.origin(b);
  }
}

}  // namespace

TEST(PropertyEconomy, UntouchedBricksHaveNeitherDisplacementNorOffset) {
  const State state = dragged(80);
  const Pose pose = invert_state(state);
  EXPECT_GT(pose.displacement.u.vectors.stored_bricks(), 0u);
  EXPECT_GT(pose.offsets.o.vectors.stored_bricks(), 0u);
  expect_local(state, pose.displacement.u);
  expect_local(state, pose.offsets.o);
  // They are known to be at rest all the same.
  Vec3f vector(1);
  ASSERT_TRUE(pose.offsets.o.at({4, 4, 4}, vector));
  EXPECT_EQ(vector, Vec3f(0));
}

TEST(PropertyEconomy, TheFieldsOfADragDoNotGrowWithTheTissueAroundIt) {
  const Pose small = invert_state(dragged(64)), large = invert_state(dragged(128));
  EXPECT_GT(large.offsets.o.topology.brick_count(), 6 * small.offsets.o.topology.brick_count());
  EXPECT_EQ(large.displacement.u.vectors.stored_bricks(),
            small.displacement.u.vectors.stored_bricks());
  EXPECT_EQ(large.offsets.o.vectors.stored_bricks(), small.offsets.o.vectors.stored_bricks());
}

TEST(PropertyEconomy, ALiveDisplacementStoresWhatMoves) {
  const State state = dragged(80);
  LiveDisplacement live(state.geometry, state.elements, state.density.bricks());
  EXPECT_EQ(live.displacement().u.vectors.stored_bricks(), 0u);
  live.update(state.q);
  EXPECT_GT(live.displacement().u.vectors.stored_bricks(), 0u);
  for (std::size_t b = 0; b < live.displacement().u.topology.brick_count(); ++b) {
    if (live.displacement().u.vectors.brick(b) == nullptr) continue;
    EXPECT_TRUE(is_near_motion(state, live.displacement().u.topology.origin(b), 2));
  }
}

TEST(PropertyEconomy, ASparseWarpIsTheFileThatItsSlicesGive) {
  const TemporaryFolder folder;
  const State state = dragged(64);
  const Pose pose = invert_state(state);
  const BrickTopology& source = state.density.bricks();
  const auto sparse = sparse_offsets(pose.offsets, source);
  ASSERT_TRUE(sparse);
  EXPECT_LT(sparse->vectors.stored_bricks(), 8u * 8 * 8 / 4);
  const auto slices = dense_offsets(pose.offsets, source, state.geometry, VoidMode::nearest);
  write_warp(folder / "slices.vdb", {state.geometry}, slices);
  write_warp(folder / "bricks.vdb", {state.geometry}, *sparse);
  EXPECT_EQ(read_text(folder / "bricks.vdb"), read_text(folder / "slices.vdb"));

  WarpJumps of_slices(state.geometry), of_bricks(state.geometry);
  std::vector<Vec3f> slice(64 * 64);
  for (int k = 0; k < 64; ++k) {
    slices(k, slice.data());
    of_slices.add(slice.data());
  }
  of_bricks.add(*sparse);
  EXPECT_GT(of_slices.largest_mm(), 0);
  EXPECT_EQ(of_bricks.largest_mm(), of_slices.largest_mm());
  EXPECT_EQ(of_bricks.folded_pairs(), of_slices.folded_pairs());
}
