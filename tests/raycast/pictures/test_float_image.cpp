// Pictures in floats and the files made of them: 8 and 16 bits, EXR.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <gtest/gtest.h>
#include <png.h>

#include "raycast/pictures/image.h"
#include "tests/support/temporary_folder.h"
#include "volumes/base/atomic_file.h"

namespace supple {
namespace {

/// The stored 16-bit values, 4 per pixel, by libpng itself.
std::vector<int> read_16_bit(const std::string& path) {
  std::FILE* file = std::fopen(path.c_str(), "rb");
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  EXPECT_EQ(png_get_bit_depth(png, info), 16);
  std::vector<int> values;
  for (png_uint_32 y = 0; y < png_get_image_height(png, info); ++y) {
    const png_bytep row = png_get_rows(png, info)[y];
    for (png_size_t n = 0; n < png_get_rowbytes(png, info); n += 2) {
      values.push_back(row[n] * 256 + row[n + 1]);
    }
  }
  png_destroy_read_struct(&png, &info, nullptr);
  std::fclose(file);
  return values;
}

float read_channel(Imf::InputFile& file, const char* name, int x, int y) {
  const auto box = file.header().dataWindow();
  const int width = box.max.x + 1, height = box.max.y + 1;
  std::vector<float> values(std::size_t(width) * height, -7);
  Imf::FrameBuffer buffer;
  buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                 sizeof(float) * width));
  file.setFrameBuffer(buffer);
  file.readPixels(0, height - 1);
  return values[std::size_t(y) * width + x];
}

FloatImage two_pixels() {
  FloatImage picture(2, 1, true);
  picture.rgba = {0.25f, 0.125f, 0, 0.5f, 0, 0, 0, 0};  // straight 0.5, 0.25, 0
  picture.depth_mm[0] = 123.5f;
  picture.offset_mm[0] = 2.25f;
  picture.normal_lps[0] = 0, picture.normal_lps[1] = -1, picture.normal_lps[2] = 0;
  return picture;
}

TEST(UnitFloatImage, AnEightBitImageComesBackThroughFloats) {
  Image image(256, 255);
  for (int alpha = 1; alpha < 256; ++alpha) {
    for (int value = 0; value < 256; ++value) {
      std::uint8_t* rgba = &image.rgba[4 * ((alpha - 1) * 256 + value)];
      rgba[0] = std::uint8_t(value), rgba[1] = std::uint8_t(255 - value), rgba[2] = 7;
      rgba[3] = std::uint8_t(alpha);
    }
  }
  EXPECT_EQ(to_image(to_float(image)).rgba, image.rgba);
}

TEST(UnitFloatImage, SixteenBitsAreStraightAndInFileOrder) {
  const std::string path = test::output_path("raycast/deep.png");
  AtomicFile target(path);
  write_png16(target, two_pixels(), "camera");
  target.commit();
  EXPECT_EQ(read_16_bit(path), (std::vector<int>{32768, 16384, 0, 32768, 0, 0, 0, 0}));  // of 65535
  FloatImage opaque = two_pixels();
  opaque.has_alpha = false;
  const AtomicFile again(path);
  write_png16(again, opaque, "");
  EXPECT_EQ(read_16_bit(again.path()).size(), 6u);
}

TEST(UnitFloatImage, ExrHoldsLinearColoursAndNamedChannels) {
  const AtomicFile target(test::output_path("raycast/picture.exr"));
  write_exr(target, two_pixels(), {"{\"step\":0.5}"});
  Imf::InputFile file(target.path().c_str());
  EXPECT_EQ(Imf::comments(file.header()), "{\"step\":0.5}");
  std::vector<std::string> names;
  for (auto c = file.header().channels().begin(); c != file.header().channels().end(); ++c) {
    names.emplace_back(c.name());
  }
  EXPECT_EQ(names,
            (std::vector<std::string>{"A", "B", "G", "N.X", "N.Y", "N.Z", "R", "Z", "offset"}));
  // Encoded 0.5 is 0.2140 linear and 0.25 is 0.0509 (IEC 61966-2-1), times the opacity.
  EXPECT_NEAR(read_channel(file, "R", 0, 0), 0.5 * 0.21404, 1e-5);
  EXPECT_NEAR(read_channel(file, "G", 0, 0), 0.5 * 0.05088, 1e-5);
  EXPECT_EQ(read_channel(file, "A", 0, 0), 0.5f);
  EXPECT_EQ(read_channel(file, "Z", 0, 0), 123.5f);
  EXPECT_EQ(read_channel(file, "N.Y", 0, 0), -1);
  EXPECT_EQ(read_channel(file, "offset", 0, 0), 2.25f);
  EXPECT_TRUE(std::isinf(read_channel(file, "Z", 1, 0)));
  EXPECT_EQ(read_channel(file, "N.Y", 1, 0), 0);
}

TEST(UnitFloatImage, AnOpaqueExrHasNoAlphaAndAPlainOneNoDepth) {
  const AtomicFile target(test::output_path("raycast/opaque.exr"));
  FloatImage picture(3, 2);
  picture.has_alpha = false;
  write_exr(target, picture, {});
  Imf::InputFile file(target.path().c_str());
  EXPECT_EQ(file.header().channels().findChannel("A"), nullptr);
  EXPECT_EQ(file.header().channels().findChannel("Z"), nullptr);
}

TEST(UnitFloatImage, AnExrSaysItsCameraAndSpeedAndStoresHalfFloatsWhereAsked) {
  const AtomicFile target(test::output_path("raycast/half.exr"));
  ExrFacts facts;
  facts.half = true;
  facts.camera.resize(2);
  for (std::size_t n = 0; n < 16; ++n) {
    facts.camera[0][n] = double(n);
    facts.camera[1][n] = -double(n);
  }
  facts.frames_per_second = 23.976;
  write_exr(target, two_pixels(), facts);
  Imf::InputFile file(target.path().c_str());
  const auto type_of = [&](const char* name) {
    return file.header().channels().findChannel(name)->type;
  };
  for (const char* name : {"R", "G", "B", "A", "N.X", "offset"}) {
    EXPECT_EQ(type_of(name), Imf::HALF) << name;
  }
  EXPECT_EQ(type_of("Z"), Imf::FLOAT) << "depths of a metre in mm need more";
  EXPECT_NEAR(read_channel(file, "R", 0, 0), 0.5 * 0.21404, 1e-4);
  EXPECT_EQ(read_channel(file, "Z", 0, 0), 123.5f);
  EXPECT_EQ(read_channel(file, "N.Y", 0, 0), -1);
  EXPECT_EQ(Imf::worldToCamera(file.header())[1][2], 6);
  EXPECT_EQ(Imf::worldToNDC(file.header())[3][1], -13);
  EXPECT_EQ(Imf::framesPerSecond(file.header()).n, 24000);
  EXPECT_EQ(Imf::framesPerSecond(file.header()).d, 1001u);
}

TEST(UnitFloatImage, SideBySideKeepsEveryChannelOfBoth) {
  FloatImage right = two_pixels();
  right.depth_mm = {1, 2};
  const FloatImage both = side_by_side(two_pixels(), right);
  ASSERT_EQ(both.width, 4);
  EXPECT_EQ(both.depth_mm[0], 123.5f);
  EXPECT_EQ(both.depth_mm[2], 1);
  EXPECT_EQ(both.depth_mm[3], 2);
  EXPECT_EQ(both.rgba[8], 0.25f);
  EXPECT_EQ(both.normal_lps[7], -1);
}

TEST(PropertyFloatImage, TheSrgbCurveIsInvertible) {
  for (int n = 0; n <= 1000; ++n) {
    const float value = float(n) / 1000;
    EXPECT_NEAR(srgb_from_linear(linear_from_srgb(value)), value, 2e-6);
  }
}

}  // namespace
}  // namespace supple
