#include <algorithm>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "volumes/grid/brick_values.h"

using namespace supple;

namespace {

constexpr std::size_t kBrickBytes = kBrickVoxels * sizeof(std::int32_t);

bool is_all(const std::int32_t* values, std::int32_t expected) {
  return std::all_of(values, values + kBrickVoxels,
                     [=](std::int32_t value) { return value == expected; });
}

}  // namespace

TEST(UnitBrickValues, WithoutBricksEverythingReadsZero) {
  for (const BrickValues& values : {BrickValues(), BrickValues(7)}) {
    EXPECT_TRUE(values.empty());
    EXPECT_EQ(values.stored_bricks(), 0u);
    EXPECT_EQ(values.brick(0), nullptr);
    EXPECT_EQ(values.brick(1000), nullptr);
    EXPECT_TRUE(is_all(values.brick_or_zero(3), 0));
    EXPECT_EQ(values.at(3 * kBrickVoxels + 5), 0);
  }
  EXPECT_EQ(BrickValues().bytes(), 0u);
  EXPECT_EQ(BrickValues(7).brick_count(), 7u);
}

TEST(UnitBrickValues, ATouchedBrickIsStoredZeroedAndAligned) {
  BrickValues values(200);
  for (std::size_t b = 0; b < 200; b += 3) {
    std::int32_t* brick = values.touch(b);
    ASSERT_TRUE(is_all(brick, 0));
    ASSERT_EQ(reinterpret_cast<std::uintptr_t>(brick) % 64, 0u);
    std::fill_n(brick, kBrickVoxels, std::int32_t(b) + 1);
  }
  EXPECT_EQ(values.stored_bricks(), 67u);
  for (std::size_t b = 0; b < 200; ++b) {
    ASSERT_EQ(values.brick(b) != nullptr, b % 3 == 0);
    ASSERT_TRUE(is_all(values.brick_or_zero(b), b % 3 == 0 ? std::int32_t(b) + 1 : 0));
  }
}

TEST(UnitBrickValues, AReleasedBrickReadsZeroAlsoWhenTouchedAgain) {
  BrickValues values(3);
  std::fill_n(values.touch(1), kBrickVoxels, 9);
  const std::size_t bytes = values.bytes();
  values.release(1);
  values.release(1);
  values.release(2);
  EXPECT_TRUE(values.empty());
  EXPECT_EQ(values.at(kBrickVoxels), 0);
  EXPECT_TRUE(is_all(values.touch(0), 0));
  EXPECT_EQ(values.bytes(), bytes);
}

TEST(UnitBrickValues, OnlyTouchedBricksCostMemory) {
  constexpr std::size_t kBricks = 64 * 64 * 64;  // 512^3 voxels
  BrickValues values(kBricks);
  EXPECT_EQ(values.bytes(), kBricks * sizeof(void*));
  for (std::size_t b = 0; b < 1000; ++b) values.touch(200 * b);
  EXPECT_GE(values.bytes(), kBricks * sizeof(void*) + 1000 * kBrickBytes);
  EXPECT_LE(values.bytes(), kBricks * sizeof(void*) + (1000 + 64) * (kBrickBytes + 32));
  values.clear();
  EXPECT_EQ(values.bytes(), 0u);
}

TEST(UnitBrickValues, ASmallBodyHasNoRoomForBricksItDoesNotHave) {
  BrickValues values(65);
  for (std::size_t b = 0; b < 65; ++b) values.touch(b);
  EXPECT_LE(values.bytes(), 65 * (kBrickBytes + 40));
}

TEST(UnitBrickValues, CopiesAreIndependentAndMovesKeepAddresses) {
  BrickValues values(10);
  values.set(4 * kBrickVoxels + 11, -3);
  BrickValues copy = values;
  EXPECT_EQ(copy, values);
  EXPECT_EQ(copy.stored_bricks(), 1u);
  copy.set(4 * kBrickVoxels + 11, 8);
  EXPECT_EQ(values.at(4 * kBrickVoxels + 11), -3);

  std::int32_t* const address = values.touch(4);
  BrickValues moved = std::move(values);
  EXPECT_EQ(moved.brick(4), address);
  copy = std::move(moved);
  EXPECT_EQ(copy.brick(4), address);
  EXPECT_EQ(copy.at(4 * kBrickVoxels + 11), -3);
}

TEST(UnitBrickValues, EqualMeansThatEveryVoxelReadsTheSame) {
  BrickValues values(10);
  EXPECT_EQ(values, BrickValues());
  values.touch(9);
  EXPECT_EQ(values, BrickValues());
  EXPECT_EQ(BrickValues(3), values);
  values.set(9 * kBrickVoxels + 511, 1);
  EXPECT_NE(values, BrickValues());
  EXPECT_NE(BrickValues(3), values);
  BrickValues other(10);
  other.set(9 * kBrickVoxels + 511, 2);
  EXPECT_NE(values, other);
}

TEST(UnitBrickValues, ResizingKeepsTheBricksThatRemain) {
  BrickValues values(2);
  values.set(1 * kBrickVoxels, 5);
  values.resize(100);
  values.set(99 * kBrickVoxels, 6);
  EXPECT_EQ(values.at(kBrickVoxels), 5);
  values.resize(50);
  EXPECT_EQ(values.stored_bricks(), 1u);
  values.resize(100);
  EXPECT_EQ(values.at(99 * kBrickVoxels), 0);
}

TEST(PropertyBrickValues, RandomUseReadsLikeAMapFromSlotToValue) {
  std::mt19937 random(3);
  for (int n = 0; n < 20; ++n) {
    const std::size_t bricks = 1 + random() % 150;
    BrickValues values(bricks);
    std::map<std::size_t, std::int32_t> expected;
    for (int step = 0; step < 2000; ++step) {
      const std::size_t slot = random() % (bricks * kBrickVoxels), b = slot / kBrickVoxels;
      if (random() % 4 == 0) {
        values.release(b);
        expected.erase(expected.lower_bound(b * kBrickVoxels),
                       expected.lower_bound((b + 1) * kBrickVoxels));
      } else {
        values.set(slot, expected[slot] = std::int32_t(random()));
      }
      if (step == 1000) values = BrickValues(values);
    }
    for (std::size_t slot = 0; slot < bricks * kBrickVoxels; ++slot) {
      const auto found = expected.find(slot);
      ASSERT_EQ(values.at(slot), found == expected.end() ? 0 : found->second);
    }
  }
}
