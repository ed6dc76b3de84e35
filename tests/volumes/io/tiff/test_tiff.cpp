// TIFF files of many pages, written by libtiff, and the metadata of ImageJ.
#include <gtest/gtest.h>

#include "tests/volumes/io/tiff_fixtures.h"
#include "volumes/base/error.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {
namespace {

TEST(UnitTiffPages, ThePagesAreTheSlicesInOrder) {
  const TemporaryFolder folder;
  for (const char* mode : {"wl", "wb", "w8"}) {
    TiffOptions options;
    options.mode = mode;
    write_tiff_pages(folder / "a.tif", 4, 3, options, lettered_pages(5, 12));
    const auto file = open_volume(folder / "a.tif");
    EXPECT_EQ(file->header().geometry.dims(), Vec3i(4, 3, 5));
    EXPECT_EQ(read_all(*file), std::string(12, 'a') + std::string(12, 'b') + std::string(12, 'c') +
                                   std::string(12, 'd') + std::string(12, 'e'));
  }
}

TEST(UnitTiffPages, EveryTypeIsReadInBothByteOrders) {
  const TemporaryFolder folder;
  const std::string bytes = "0123456789abcdefghijklmnopqrstuvABCDEFGHIJKLMNOP";  // 6 x 8 bytes
  const char* const kinds[] = {"", "uint", "int", "float"};
  for (const char* mode : {"wl", "wb"}) {
    for (const int format : {1, 2, 3}) {
      for (const int bits : {8, 16, 32, 64}) {
        if (format == 3 && bits < 32) continue;
        TiffOptions options;
        options.mode = mode;
        options.bits = bits;
        options.sample_format = format;
        const std::string rows = bytes.substr(0, std::size_t(bits) / 8 * 6);
        write_tiff(folder / "a.tif", 3, 2, options, rows);
        const auto file = open_volume(folder / "a.tif");
        EXPECT_EQ(numpy_name(file->header().type), kinds[format] + std::to_string(bits));
        EXPECT_EQ(read_all(*file), rows) << mode << kinds[format] << bits;
      }
    }
  }
}

TEST(UnitTiffPages, ReducedCopiesArePassedOver) {
  const TemporaryFolder folder;
  TiffOptions page, thumbnail;
  thumbnail.subfile = 1;
  write_tiff(folder / "a.tif", 1, 1, thumbnail, "t");
  page.mode = thumbnail.mode = "a";
  write_tiff(folder / "a.tif", 2, 1, page, "ab");
  write_tiff(folder / "a.tif", 1, 1, thumbnail, "t");
  write_tiff(folder / "a.tif", 2, 1, page, "cd");
  EXPECT_EQ(read_all(folder / "a.tif"), "abcd");
  thumbnail.mode = "w";
  write_tiff(folder / "t.tif", 1, 1, thumbnail, "t");
  EXPECT_NE(failure_of(folder / "t.tif").find("reduced"), std::string::npos);
}

TEST(UnitTiffPages, SamplesAreComponentsWhetherTogetherInPlanesOrInTiles) {
  const TemporaryFolder folder;
  const std::string together = "RGBrgbXYZxyzUVWuvw", planes = "RrXxUuGgYyVvBbZzWw";
  for (const int tile : {0, 16}) {
    TiffOptions options;
    options.samples = 3;
    options.photometric = 2;
    options.tile = tile;
    write_tiff(folder / "a.tif", 3, 2, options, together);
    ReadOptions green;
    green.channel = 1;
    EXPECT_EQ(read_all(*open_volume(folder / "a.tif", green)), "GgYyVv") << tile;
  }
  TiffOptions options;
  options.samples = 3;
  options.planar = true;
  write_tiff(folder / "p.tif", 3, 2, options, planes);
  ReadOptions blue;
  blue.channel = 2;
  EXPECT_EQ(read_all(*open_volume(folder / "p.tif", blue)), "BbZzWw");
  EXPECT_NE(failure_of(folder / "p.tif").find("3 components"), std::string::npos);
}

TEST(UnitTiffSpacing, ResolutionCountsWhereItsUnitIsALengthAndNoScreens) {
  const TemporaryFolder folder;
  struct Case {
    double x, y;
    int unit;
    Vec3d spacing;
    std::size_t warnings;
  };
  const Case cases[] = {{0, 0, 0, {1, 1, 1}, 0},
                        {20, 40, 3, {0.5, 0.25, 1}, 1},
                        {254, 127, 2, {0.1, 0.2, 1}, 1},
                        {72, 72, 2, {1, 1, 1}, 1},
                        {96, 96, 2, {1, 1, 1}, 1},
                        {20, 40, 1, {1, 1, 1}, 0},
                        {300, 300, 2, {25.4 / 300, 25.4 / 300, 1}, 1}};
  for (const Case& expected : cases) {
    TiffOptions options;
    options.x_resolution = expected.x;
    options.y_resolution = expected.y;
    options.resolution_unit = expected.unit;
    write_tiff_pages(folder / "a.tif", 2, 2, options, lettered_pages(2, 4));
    const auto file = open_volume(folder / "a.tif");
    const Vec3d spacing = file->header().geometry.spacing_mm();
    for (int a = 0; a < 3; ++a) EXPECT_DOUBLE_EQ(spacing[a], expected.spacing[a]) << expected.x;
    EXPECT_EQ(file->header().warnings.size(), expected.warnings) << expected.x;
  }
}

TEST(UnitImageJ, SpacingIsInTheUnitOfTheDescription) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, double>> units = {
      {"mm", 1},           {"cm", 10},   {"um", 1e-3},   {"micron", 1e-3}, {"\\u00B5m", 1e-3},
      {"\xc2\xb5m", 1e-3}, {"nm", 1e-6}, {"inch", 25.4}, {"furlong", 1}};
  for (const auto& [unit, mm] : units) {
    TiffOptions options;
    options.description =
        "ImageJ=1.53t\nimages=2\nslices=2\nunit=" + unit + "\nspacing=1.5\nloop=false\n";
    options.x_resolution = 2;
    options.y_resolution = 4;
    options.resolution_unit = 1;
    write_tiff_pages(folder / "a.tif", 2, 2, options, lettered_pages(2, 4));
    const auto file = open_volume(folder / "a.tif");
    const Vec3d spacing = file->header().geometry.spacing_mm();
    const Vec3d expected = Vec3d(0.5, 0.25, 1.5) * mm;
    for (int a = 0; a < 3; ++a) EXPECT_DOUBLE_EQ(spacing[a], expected[a]) << unit;
    EXPECT_EQ(file->header().warnings.size(), unit == "furlong" ? 1u : 0u) << unit;
  }
}

TEST(UnitImageJ, HyperstacksCountChannelsThenSlicesThenFrames) {
  const TemporaryFolder folder;
  TiffOptions options;
  options.description =
      "ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\nhyperstack=true\n";
  write_tiff_pages(folder / "a.tif", 1, 1, options, lettered_pages(12, 1));  // a to l
  EXPECT_NE(failure_of(folder / "a.tif").find("frame 0 to 1"), std::string::npos);
  ReadOptions second;
  second.frame = 1;
  EXPECT_NE(failure_of(folder / "a.tif", second).find("channel 0 to 1"), std::string::npos);
  second.channel = 1;
  EXPECT_EQ(read_all(*open_volume(folder / "a.tif", second)), "hjl");
  options.description += "order=zct\n";
  write_tiff_pages(folder / "b.tif", 1, 1, options, lettered_pages(12, 1));
  EXPECT_EQ(read_all(*open_volume(folder / "b.tif", second)), "jkl");
}

TEST(UnitImageJ, AStackWithoutNamedAxesIsOneOfSlices) {
  const TemporaryFolder folder;
  TiffOptions options;
  options.description = "ImageJ=1.53t\nimages=3\n";
  write_tiff_pages(folder / "a.tif", 1, 1, options, lettered_pages(3, 1));
  EXPECT_EQ(read_all(folder / "a.tif"), "abc");
}

TEST(UnitImageJ, ARunOfImagesBehindOneDirectoryIsReadInEitherByteOrder) {
  const TemporaryFolder folder;
  for (const char* mode : {"wl", "wb"}) {
    // The directory goes first, as ImageJ puts it, so that the values end the file.
    std::string bytes =
        mode[1] == 'b' ? std::string("MM\0*\0\0\0\x08", 8) : std::string("II*\0\x08\0\0\0", 8);
    const auto number = [&](std::uint32_t value, int width) {
      for (int n = 0; n < width; ++n) {
        bytes += char(value >> 8 * (mode[1] == 'b' ? width - 1 - n : n));
      }
    };
    const std::string text = "ImageJ=1.53t\nimages=3\nslices=3\nspacing=2\nunit=mm\n";
    const std::uint32_t text_at = 8 + 2 + 12 * 8 + 4, first = text_at + 100;
    const std::uint32_t entries[8][4] = {{256, 3, 1, 2},
                                         {257, 3, 1, 1},
                                         {258, 3, 1, 16},
                                         {262, 3, 1, 1},
                                         {270, 2, std::uint32_t(text.size()) + 1, text_at},
                                         {273, 4, 1, first},
                                         {278, 3, 1, 1},
                                         {279, 4, 1, 4}};
    number(8, 2);
    for (const auto& entry : entries) {
      number(entry[0], 2);
      number(entry[1], 2);
      number(entry[2], 4);
      number(entry[3], entry[1] == 3 ? 2 : 4);
      if (entry[1] == 3) number(0, 2);
    }
    number(0, 4);
    bytes += text;
    bytes.resize(first, '\0');
    const std::vector<std::uint16_t> values = {1, 2, 300, 400, 50000, 60000};
    bytes += bytes_of_values(values, mode[1] == 'b');
    const auto file = open_volume(folder.write("run.tif", bytes));
    EXPECT_EQ(file->header().geometry.dims(), Vec3i(2, 1, 3));
    EXPECT_EQ(file->header().geometry.spacing_mm().z, 2);
    EXPECT_EQ(read_all(*file), bytes_of_values(values)) << mode;
    bytes.pop_back();
    const std::string line = failure_of(folder.write("short.tif", bytes));
    EXPECT_NE(line.find("file length"), std::string::npos) << line;
  }
}

TEST(UnitImageJ, ColourMapsOfImageJAreForDisplay) {
  const TemporaryFolder folder;
  TiffOptions options;
  options.photometric = 3;
  write_tiff(folder / "a.tif", 2, 1, options, "ab");
  EXPECT_NE(failure_of(folder / "a.tif").find("palette"), std::string::npos);
  options.description = "ImageJ=1.53t\nimages=1\n";
  write_tiff(folder / "b.tif", 2, 1, options, "ab");
  EXPECT_EQ(read_all(folder / "b.tif"), "ab");
}

}  // namespace
}  // namespace supple::test
