#include <algorithm>
#include <deque>
#include <map>
#include <random>
#include <tuple>

#include <gtest/gtest.h>

#include "volumes/grid/density_grid.h"

namespace supple::test {
namespace {

/// Voxels of a topology in brick order, each with the number of its piece, by flooding.
struct FloodedPieces {
  std::vector<Vec3i> voxels;
  std::map<std::tuple<int, int, int>, int> piece_of;
  std::vector<int> sizes;

  explicit FloodedPieces(const BrickTopology& topology) {
    for (std::size_t b = 0; b < topology.brick_count(); ++b) {
      for_each_active(topology.mask(b), [&](int offset) {
        voxels.push_back(topology.origin(b) + brick_local(offset));
      });
    }
    for (const Vec3i& voxel : voxels) {
      if (piece_of.count(key(voxel)) == 0) flood(topology, voxel);
    }
  }
  static std::tuple<int, int, int> key(const Vec3i& v) { return {v.x, v.y, v.z}; }

  void flood(const BrickTopology& topology, const Vec3i& seed) {
    const int piece = int(sizes.size());
    sizes.push_back(0);
    std::deque<Vec3i> queue = {seed};
    piece_of[key(seed)] = piece;
    while (!queue.empty()) {
      const Vec3i voxel = queue.front();
      queue.pop_front();
      ++sizes[piece];
      for (int face = 0; face < 6; ++face) {
        Vec3i next = voxel;
        next[face / 2] += face % 2 != 0 ? 1 : -1;
        if (!topology.is_active(next) || !piece_of.emplace(key(next), piece).second) continue;
        queue.push_back(next);
      }
    }
  }

  /// Pieces from the largest on, of equal ones the one whose first voxel comes first.
  std::vector<int> by_size() const {
    std::vector<int> order(sizes.size());
    for (std::size_t n = 0; n < order.size(); ++n) order[n] = int(n);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return sizes[a] > sizes[b]; });
    return order;
  }
};

/// Voxels of a box around the origin, each active where `is_active` says so.
template <class IsActive>
BrickTopology box_topology(int radius, const IsActive& is_active) {
  std::map<std::tuple<int, int, int>, BrickMask> bricks;
  for (int i = -radius; i < radius; ++i) {
    for (int j = -radius; j < radius; ++j) {
      for (int k = -radius; k < radius; ++k) {
        if (!is_active(i, j, k)) continue;
        const auto brick = bricks.emplace(std::tuple(i & ~7, j & ~7, k & ~7), BrickMask{}).first;
        mask_set(brick->second, brick_offset({i, j, k}));
      }
    }
  }
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (const auto& [origin, mask] : bricks) {
    origins.push_back(std::make_from_tuple<Vec3i>(origin));
    masks.push_back(mask);
  }
  return {origins, masks};
}

void expect_flooded_pieces(const BrickTopology& topology, int count) {
  const FloodedPieces flooded(topology);
  std::vector<int> kept = flooded.by_size();
  if (kept.size() > std::size_t(count)) kept.resize(count);
  const BrickTopology found = largest_components(topology, count);
  std::int64_t expected_count = 0;
  for (const Vec3i& voxel : flooded.voxels) {
    const int piece = flooded.piece_of.at(FloodedPieces::key(voxel));
    const bool expected = std::find(kept.begin(), kept.end(), piece) != kept.end();
    expected_count += expected;
    ASSERT_EQ(found.is_active(voxel), expected) << voxel << " of the " << count << " largest";
  }
  EXPECT_EQ(found.active_count(), expected_count);
}

TEST(PropertyComponents, TheLargestOfAnyNoiseAreThoseOfAFlood) {
  std::mt19937 random(5);
  for (const int percent : {2, 10, 25, 31, 40, 60, 95}) {
    const BrickTopology topology =
        box_topology(12, [&](int, int, int) { return int(random() % 100) < percent; });
    for (const int count : {1, 2, 7, 100}) expect_flooded_pieces(topology, count);
  }
}

TEST(PropertyComponents, SheetsMeetAcrossAllFacesOfBricks) {
  for (int axis = 0; axis < 3; ++axis) {
    const BrickTopology topology = box_topology(16, [&](int i, int j, int k) {
      const Vec3i voxel(i, j, k);
      const int other = voxel[(axis + 1) % 3];
      return (other & 3) == 0 || (other == 5 && voxel[axis] == 7);
    });
    for (const int count : {1, 2, 3, 8}) expect_flooded_pieces(topology, count);
  }
}

TEST(PropertyComponents, ThePieceAtAVoxelIsThatOfAFlood) {
  std::mt19937 random(6);
  for (const int percent : {10, 31, 40, 95}) {
    const BrickTopology topology =
        box_topology(12, [&](int, int, int) { return int(random() % 100) < percent; });
    const FloodedPieces flooded(topology);
    for (int n = 0; n < 20; ++n) {
      const Vec3i& at = flooded.voxels[random() % flooded.voxels.size()];
      const int piece = flooded.piece_of.at(FloodedPieces::key(at));
      const BrickTopology found = component_at(topology, at);
      EXPECT_EQ(found.active_count(), flooded.sizes[std::size_t(piece)]);
      for (const Vec3i& voxel : flooded.voxels) {
        ASSERT_EQ(found.is_active(voxel), flooded.piece_of.at(FloodedPieces::key(voxel)) == piece);
      }
    }
  }
  EXPECT_TRUE(
      component_at(box_topology(8, [](int i, int, int) { return i > 0; }), {0, 0, 0}).empty());
}

TEST(UnitComponents, ACheckerboardIsAllSinglesWhichOrderByTheirPlace) {
  const BrickTopology topology =
      box_topology(8, [](int i, int j, int k) { return ((i + j + k) & 1) == 0; });
  const BrickTopology found = largest_components(topology, 257);
  EXPECT_EQ(found.active_count(), 257);
  EXPECT_EQ(found.brick_count(), 2u);
  EXPECT_EQ(found.mask(0), topology.mask(0));
  EXPECT_TRUE(found.is_active({-8, -8, 0}));
}

}  // namespace
}  // namespace supple::test
