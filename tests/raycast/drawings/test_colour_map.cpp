// Scalars as colours with a legend.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "raycast/drawings/value_images.h"

namespace supple {
namespace {

using Colour = std::array<int, 3>;

Colour pixel(const Image& image, int x, int y) {
  const std::uint8_t* rgba = &image.rgba[4 * (std::size_t(y) * image.width + x)];
  return {rgba[0], rgba[1], rgba[2]};
}

/// Entries 245 and 50 of magma as published by its authors (S. van der Walt, N. Smith, 2015).
constexpr Colour kFirstColour = {253, 235, 172}, kLastColour = {57, 15, 110};
constexpr Colour kWhite = {255, 255, 255};

TEST(UnitColourMap, TicksAreRoundNumbersInsideTheRange) {
  EXPECT_EQ(legend_ticks({0, 12}), (std::vector<double>{0, 2, 4, 6, 8, 10, 12}));
  EXPECT_EQ(legend_ticks({0, 10}), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(legend_ticks({431, 502}), (std::vector<double>{440, 460, 480, 500}));
  EXPECT_TRUE(legend_ticks({3, 3}).empty());
  for (const double hi : {0.013, 0.7, 4.0, 99.0, 12345.0}) {
    const std::size_t count = legend_ticks({0, hi}).size();
    EXPECT_GE(count, 4u) << hi;
    EXPECT_LE(count, 8u) << hi;
  }
}

TEST(UnitColourMap, TheEndsOfTheRangeHaveTheEndsOfTheMapAndTurnedSurfacesAreDarker) {
  FloatImage picture(4, 1, true);
  picture.offset_mm = {0, 6, 6, NAN};
  picture.depth_mm = picture.offset_mm;
  picture.normal_lps = {0, -1, 0, 0, -1, 0, 0, 0, 1, NAN, NAN, NAN};
  const Image image = offset_image(picture, {0, 6}, {0, -1, 0});
  EXPECT_EQ(pixel(image, 0, 0), kFirstColour);
  EXPECT_EQ(pixel(image, 1, 0), kLastColour);
  EXPECT_NEAR(pixel(image, 2, 0)[0], 0.55 * kLastColour[0], 0.51);
  EXPECT_EQ(pixel(image, 3, 0), kWhite);
  EXPECT_FALSE(image.has_alpha);
}

TEST(UnitColourMap, TheLegendRunsFromTheLeastAtItsFootToTheMostAtItsHead) {
  const FloatImage nothing(300, 240, true);
  const Image image = offset_image(nothing, {0, 6}, {0, -1, 0});
  std::vector<Colour> bar;
  for (int x = 0; x < image.width && bar.empty(); ++x) {
    if (pixel(image, x, 120) == kWhite) continue;
    EXPECT_GE(x, 300);
    constexpr int kRim = 6;  // and its halo
    for (int y = 0; y < 240; ++y) {
      const Colour colour = pixel(image, x + kRim, y);
      const auto [least, most] = std::minmax_element(colour.begin(), colour.end());
      if (*most - *least > 60) bar.push_back(colour);  // neither paper nor ink, nor their mixture
    }
  }
  ASSERT_GT(bar.size(), 100u);
  EXPECT_GT(image.width, 350);
  for (std::size_t c = 0; c < 3; ++c) {
    // Halos of the rim are above and below.
    EXPECT_NEAR(bar[bar.size() - 5][c], kFirstColour[c], 35);
    EXPECT_NEAR(bar[4][c], kLastColour[c], 35);
  }
  const Image small = offset_image(FloatImage(100, 100, true), {0, 6}, {0, -1, 0});
  EXPECT_EQ(small.width, 100);
}

TEST(UnitColourMap, NormalsAreColoursOfLeftPosteriorSuperior) {
  FloatImage picture(2, 1, true);
  picture.depth_mm = {5, NAN};
  picture.normal_lps = {0, -1, 1, NAN, NAN, NAN};
  const Image image = normal_image(picture);
  EXPECT_EQ(pixel(image, 0, 0), (Colour{128, 0, 255}));
  EXPECT_EQ(image.rgba[3], 255);
  EXPECT_EQ(image.rgba[7], 0);
}

TEST(UnitColourMap, NearIsBrightAndTheRangeIsThatOfWhatIsThere) {
  FloatImage picture(3, 1, true);
  picture.depth_mm = {100, 200, NAN};
  const ScalarRange range = range_of(picture.depth_mm);
  EXPECT_EQ(range.lo, 100);
  EXPECT_EQ(range.hi, 200);
  const Image image = depth_image(picture, range);
  EXPECT_EQ(pixel(image, 0, 0), kWhite);
  EXPECT_EQ(pixel(image, 1, 0), (Colour{30, 30, 30}));
  EXPECT_EQ(pixel(image, 2, 0), (Colour{0, 0, 0}));
}

}  // namespace
}  // namespace supple
