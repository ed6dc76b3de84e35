// PNG files and image comparison.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include <gtest/gtest.h>

#include "raycast/pictures/compare.h"
#include "tests/support/temporary_folder.h"
#include "volumes/base/error.h"

namespace supple {
namespace {

Image noise(int width, int height, unsigned seed, bool has_alpha = true) {
  std::mt19937 random(seed);
  Image image(width, height);
  image.has_alpha = has_alpha;
  for (std::size_t n = 0; n < image.rgba.size(); ++n) {
    image.rgba[n] = !has_alpha && n % 4 == 3 ? 255 : std::uint8_t(random());
  }
  return image;
}

Image uniform(int width, int height, std::array<std::uint8_t, 4> rgba) {
  Image image(width, height);
  for (std::size_t n = 0; n < image.rgba.size(); ++n) image.rgba[n] = rgba[n % 4];
  return image;
}

void write_text(const std::string& path, const std::vector<unsigned char>& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
}

std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// 3x1 pixels, written by an independent encoder.
const std::vector<unsigned char> kGrey16 = {
#include "tests/raycast/pictures/png_grey16.inc"
};
const std::vector<unsigned char> kPalette = {
#include "tests/raycast/pictures/png_palette.inc"
};

TEST(UnitImage, PngRoundTripKeepsEveryByteWithAndWithoutAlpha) {
  for (const bool has_alpha : {true, false}) {
    const Image image = noise(37, 11, 1, has_alpha);
    const std::string path = test::output_path("raycast/round_trip.png");
    write_png(path, image, "step = 0.5");
    const Image back = read_png(path);
    EXPECT_EQ(back.width, 37);
    EXPECT_EQ(back.height, 11);
    EXPECT_EQ(back.has_alpha, has_alpha);
    EXPECT_EQ(back.rgba, image.rgba);
  }
}

TEST(UnitImage, TheCommentIsInTheFileAndEqualImagesAreEqualFiles) {
  const std::string path = test::output_path("raycast/comment.png"),
                    again = test::output_path("raycast/again.png");
  write_png(path, noise(5, 4, 2), "camera = anterior");
  write_png(again, noise(5, 4, 2), "camera = anterior");
  EXPECT_NE(read_bytes(path).find("camera = anterior"), std::string::npos);
  EXPECT_EQ(read_bytes(path), read_bytes(again));
}

TEST(UnitImage, SixteenBitGreyAndPaletteImagesAreExpanded) {
  const std::string grey = test::output_path("raycast/grey16.png"),
                    palette = test::output_path("raycast/palette.png");
  write_text(grey, kGrey16);
  write_text(palette, kPalette);
  const Image a = read_png(grey);
  EXPECT_FALSE(a.has_alpha);
  EXPECT_EQ(a.rgba,
            (std::vector<std::uint8_t>{0, 0, 0, 255, 128, 128, 128, 255, 255, 255, 255, 255}));
  const Image b = read_png(palette);
  EXPECT_EQ(b.rgba, (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 255, 0, 255, 1, 2, 3, 255}));
}

TEST(UnitImage, UnusableFilesAreInputErrors) {
  EXPECT_THROW(read_png(test::output_path("raycast/missing.png")), InputError);
  EXPECT_THROW(read_png(std::filesystem::path(test::output_path("raycast/x")).parent_path()),
               InputError);
  const std::string path = test::output_path("raycast/bad.png");
  write_text(path, {'P', '6', ' ', '1'});
  EXPECT_THROW(read_png(path), InputError);
  std::vector<unsigned char> cut = kGrey16;
  cut.resize(cut.size() - 20);
  write_text(path, cut);
  EXPECT_THROW(read_png(path), InputError);
  EXPECT_THROW(write_png(test::output_path("raycast/no") + "/such/folder.png", noise(2, 2, 3)),
               InputError);
}

TEST(UnitCompare, EqualImagesHaveSsimOneAndNoDifference) {
  const Image image = noise(40, 30, 4);
  const Comparison same = compare(image, image, false);
  EXPECT_DOUBLE_EQ(same.ssim, 1);
  EXPECT_EQ(same.rmse, 0);
  EXPECT_EQ(same.max_diff, 0);
  EXPECT_EQ(same.compared_pixels, 1200);
}

TEST(UnitCompare, UniformImagesByHand) {
  // SSIM without variance is the luminance term (2ab + C1) / (a^2 + b^2 + C1).
  const Image a = uniform(16, 16, {255, 255, 255, 255}), b = uniform(16, 16, {51, 51, 51, 255});
  const Comparison result = compare(a, b, false);
  EXPECT_NEAR(result.ssim, (2 * 0.2 + 1e-4) / (1 + 0.04 + 1e-4), 1e-9);
  EXPECT_NEAR(result.rmse, 0.8, 1e-12);  // that alpha is the same makes it no smaller
  EXPECT_EQ(result.rmse_alpha, 0);
  EXPECT_NEAR(result.max_diff, 0.8, 1e-12);
}

TEST(UnitCompare, AlphaIsANumberBesideTheColoursOnBlack) {
  // White of alpha 0.2 is an opaque grey of 0.2 on black, so that alpha alone differs, by 0.8.
  const Image thin = uniform(9, 9, {255, 255, 255, 51}), grey = uniform(9, 9, {51, 51, 51, 255});
  const Comparison result = compare(thin, grey, false);
  EXPECT_NEAR(result.max_diff, 0.8, 1e-12);
  EXPECT_NEAR(result.rmse, 0, 1e-12);
  EXPECT_NEAR(result.rmse_alpha, 0.8, 1e-12);
  EXPECT_NEAR(result.ssim, 1, 1e-12);
  EXPECT_EQ(difference_image(thin, grey).rgba[0], 255);
  Image rgb = grey;
  rgb.has_alpha = false;
  EXPECT_EQ(compare(grey, rgb, false).max_diff, 0) << "opaque without alpha";
  EXPECT_NEAR(compare(thin, rgb, false).max_diff, 0.8, 1e-12);
}

TEST(UnitCompare, ForegroundCountsPixelsWhereEitherImageIsNotTransparent) {
  Image a(10, 10), b(10, 10);
  a.rgba[3] = 255;  // pixel 0
  b.rgba[7] = 255;  // pixel 1
  b.rgba[4] = 255;
  EXPECT_EQ(compare(a, b, true).compared_pixels, 2);
  EXPECT_NEAR(compare(a, b, true).rmse, std::sqrt(1.0 / 6), 1e-12);
  EXPECT_NEAR(compare(a, b, true).rmse_alpha, 1, 1e-12);
  EXPECT_EQ(compare(a, b, false).compared_pixels, 100);
  EXPECT_EQ(compare(Image(4, 4), Image(4, 4), true).compared_pixels, 0);
  EXPECT_THROW(compare(a, Image(10, 9), false), InputError);
}

TEST(UnitCompare, TheDifferenceImageIsAmplifiedToWhite) {
  Image a = uniform(2, 1, {0, 0, 0, 255}), b = a;
  b.rgba[0] = 10, b.rgba[5] = 5;
  const Image difference = difference_image(a, b);
  EXPECT_EQ(difference.rgba, (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 128, 0, 255}));
}

TEST(PropertyCompare, SsimFallsAsNoiseGrowsAndIsSymmetric) {
  const Image image = noise(64, 64, 5, false);
  double previous = 1;
  for (const int amplitude : {8, 32, 96}) {
    Image other = image;
    std::mt19937 random(6);
    for (std::size_t n = 0; n < other.rgba.size(); ++n) {
      const int jitter = int(random() % (2 * amplitude + 1)) - amplitude;
      if (n % 4 != 3) other.rgba[n] = std::uint8_t(std::clamp(other.rgba[n] + jitter, 0, 255));
    }
    const double ssim = compare(image, other, false).ssim;
    EXPECT_LT(ssim, previous);
    EXPECT_DOUBLE_EQ(ssim, compare(other, image, false).ssim);
    previous = ssim;
  }
}

}  // namespace
}  // namespace supple
