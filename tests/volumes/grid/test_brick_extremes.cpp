// Extremes of bricks and of their lowest faces, edges and corners, against a search voxel by voxel.
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "volumes/grid/brick_topology.h"

using namespace supple;

namespace {

BrickExtremes searched_extremes(const std::vector<float>& values, const BrickMask& mask) {
  BrickExtremes found;
  for (int part = 0; part < int(BrickExtremes::kParts); ++part) {
    float lo = HUGE_VALF, hi = -HUGE_VALF;
    for (int n = 0; n < kBrickVoxels; ++n) {
      const Vec3i at = brick_local(n);
      const bool is_beyond =
          ((part & 4) && at.x > 0) || ((part & 2) && at.y > 0) || ((part & 1) && at.z > 0);
      if (is_beyond || !mask_test(mask, n) || !std::isfinite(values[std::size_t(n)])) continue;
      lo = std::min(lo, values[std::size_t(n)]);
      hi = std::max(hi, values[std::size_t(n)]);
      found.integers =
          found.integers && std::nearbyint(values[std::size_t(n)]) == values[std::size_t(n)];
    }
    found.lo[std::size_t(part)] = lo;
    found.hi[std::size_t(part)] = hi;
  }
  return found;
}

TEST(PropertyBrickExtremes, TheyAreThoseOfASearch) {
  std::mt19937 random(12);
  std::uniform_real_distribution<float> fraction(-500, 500);
  const auto part = [&](int of) { return random() % unsigned(of) == 0; };
  int whole = 0, empty = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const bool has_fractions = part(2), has_odd = part(3), has_large = part(4), is_whole = part(2);
    const float odd = part(2) ? HUGE_VALF : std::numeric_limits<float>::quiet_NaN();
    std::vector<float> values(kBrickVoxels);
    for (float& value : values) {
      value = float(int(random() % 4000)) - 1000;
      if (has_fractions && part(300)) value = fraction(random);
      if (has_large && part(50)) value = 5000001;
      if (has_odd && part(40)) value = odd;
    }
    BrickMask mask{};
    for (int n = 0; n < kBrickVoxels; ++n) {
      if (is_whole || part(1 + trial % 40)) mask_set(mask, n);
    }
    const BrickExtremes found = find_extremes(values.data(), mask),
                        expected = searched_extremes(values, mask);
    EXPECT_EQ(found.lo, expected.lo) << trial;
    EXPECT_EQ(found.hi, expected.hi) << trial;
    EXPECT_EQ(found.integers, expected.integers) << trial;
    whole += found.integers;
    empty += found.lo[7] > found.hi[7];
  }
  EXPECT_GT(whole, 100);
  EXPECT_LT(whole, 350);
  EXPECT_GT(empty, 50);
}

}  // namespace
