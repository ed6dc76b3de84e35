// TIFF files that we write, read back by libtiff itself and by our reader.
#include <cstring>

#include <gtest/gtest.h>
#include <tiffio.h>

#include "tests/support/temporary_folder.h"
#include "volumes/base/error.h"
#include "volumes/io/format/dense_writer.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/tiff/tiff_tags.h"

using namespace supple;
using namespace supple::test;

namespace {

Geometry plain_grid(const Vec3i& dims) {
  return {dims, {0, 0, 0}, {Vec3d(0.957, 0, 0), {0, 0.3, 0}, {0, 0, 1.5}}};
}

/// Bytes that count up, so that no two rows or pages are alike.
std::string counting_bytes(const DenseImage& image) {
  const Vec3i& dims = image.geometry.dims();
  std::string bytes(std::size_t(dims.x) * dims.y * dims.z * bytes_of(image.type), '\0');
  for (std::size_t n = 0; n < bytes.size(); ++n) bytes[n] = char(n * 7 + n / 251);
  return bytes;
}

std::vector<std::string> write_tiff_volume(const std::string& path, const DenseImage& image,
                                           bool compress, const std::string& bytes) {
  WriteOptions options;
  options.compress = compress;
  const auto writer = create_dense(path, image, options);
  const std::size_t slice = bytes.size() / std::size_t(image.geometry.dims().z);
  for (int k = 0; k < image.geometry.dims().z; ++k) writer->write_slice(&bytes[slice * k]);
  writer->commit();
  return writer->warnings();
}

std::string pages_by_libtiff(const std::string& path, int& pages) {
  std::string bytes;
  TIFF* tiff = TIFFOpen(path.c_str(), "r");
  pages = 0;
  do {
    std::string strip(std::size_t(TIFFStripSize(tiff)), '\0');
    for (std::uint32_t n = 0; n < TIFFNumberOfStrips(tiff); ++n) {
      const tmsize_t size = TIFFReadEncodedStrip(tiff, n, strip.data(), tmsize_t(strip.size()));
      bytes += strip.substr(0, std::size_t(size));
    }
    ++pages;
  } while (TIFFReadDirectory(tiff) != 0);
  TIFFClose(tiff);
  return bytes;
}

TEST(UnitTiffWriter, LibtiffReadsTheBytesOfEveryTypePlainAndCompressed) {
  const TemporaryFolder folder;
  for (int type = 0; type < 10; ++type) {
    for (const bool compress : {false, true}) {
      DenseImage image;
      image.geometry = plain_grid({7, 5, 4});
      image.type = ValueType(type);
      const std::string bytes = counting_bytes(image);
      EXPECT_TRUE(write_tiff_volume(folder / "a.tif", image, compress, bytes).empty());
      int pages = 0;
      EXPECT_EQ(pages_by_libtiff(folder / "a.tif", pages), bytes) << numpy_name(image.type);
      EXPECT_EQ(pages, 4);
      EXPECT_EQ(folder.entries().size(), 1u);
    }
  }
}

TEST(UnitTiffWriter, RowsOfSeveralStripsStayInOrderAndDeflateShrinksThem) {
  const TemporaryFolder folder;
  DenseImage image;
  image.geometry = plain_grid({700, 900, 2});
  image.type = ValueType::uint16;
  std::string bytes(std::size_t(2) * 700 * 900 * 2, '\0');
  for (std::size_t n = 0; n < bytes.size() / 2; ++n) {
    const auto value = std::uint16_t(n / 3);
    std::memcpy(&bytes[2 * n], &value, 2);
  }
  int pages = 0;
  for (const bool compress : {false, true}) {
    write_tiff_volume(folder / "a.tiff", image, compress, bytes);
    EXPECT_EQ(pages_by_libtiff(folder / "a.tiff", pages), bytes);
    const std::size_t size = read_text(folder / "a.tiff").size();
    EXPECT_EQ(size < bytes.size() / 10, compress) << size;
  }
}

TEST(UnitTiffWriter, ThePlainFormatServesBelowFourGigabytesAndBigTiffAbove) {
  const TemporaryFolder folder;
  const auto mark = [&](int slices) {
    DenseImage image;
    image.geometry = plain_grid({2000, 1000, slices});
    image.type = ValueType::float32;
    const auto writer = create_dense(folder / "a.tif", image);
    writer->write_slice(std::string(8000000, 'a').data());
    for (const auto& entry : std::filesystem::directory_iterator(folder / "")) {
      return int(read_text(entry.path().string()).at(2));
    }
    return 0;
  };
  EXPECT_EQ(mark(500), 42);
  EXPECT_EQ(mark(530), 43);
  EXPECT_EQ(folder.entries().size(), 0u);
}

/// A file of two pages of 3 x 1 bytes, in either format.
std::string two_pages(bool is_big) {
  std::string bytes = is_big ? std::string("II+\0\x08\0\0\0\x18\0\0\0\0\0\0\0", 16)
                             : std::string("II*\0\x18\0\0\0\0\0\0\0\0\0\0\0", 16);
  bytes += "abcdef\0\0";
  bytes.resize(24, '\0');
  for (int page = 0; page < 2; ++page) {
    TiffDirectory directory(is_big);
    directory.add(image_width, tiff_long, {3});
    directory.add(image_length, tiff_long, {1});
    directory.add(bits_per_sample, tiff_short, {8});
    directory.add(compression, tiff_short, {1});
    directory.add(photometric, tiff_short, {1});
    directory.add(image_description, "a text that fits into no entry");
    directory.add(strip_offsets, is_big ? tiff_long8 : tiff_long, {16u + 3u * unsigned(page)});
    directory.add(samples_per_pixel, tiff_short, {1});
    directory.add(rows_per_strip, tiff_long, {1});
    directory.add(strip_byte_counts, is_big ? tiff_long8 : tiff_long, {3});
    directory.add(x_resolution, tiff_rational, tiff_resolution(0.957));
    bytes += directory.bytes_at(bytes.size(), page == 1);
  }
  return bytes;
}

TEST(UnitTiffWriter, LibtiffReadsDirectoriesOfBothFormats) {
  const TemporaryFolder folder;
  for (const bool is_big : {false, true}) {
    write_text(folder / "a.tif", two_pages(is_big));
    int pages = 0;
    EXPECT_EQ(pages_by_libtiff(folder / "a.tif", pages), "abcdef") << is_big;
    EXPECT_EQ(pages, 2);
    TIFF* tiff = TIFFOpen((folder / "a.tif").c_str(), "r");
    float resolution = 0;
    const char* text = nullptr;
    EXPECT_EQ(TIFFGetField(tiff, TIFFTAG_XRESOLUTION, &resolution), 1);
    EXPECT_EQ(TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &text), 1);
    EXPECT_EQ(TIFFIsBigTIFF(tiff) != 0, is_big);
    EXPECT_FLOAT_EQ(resolution, float(1 / 0.957));
    EXPECT_STREQ(text, "a text that fits into no entry");
    TIFFClose(tiff);
  }
}

TEST(UnitTiffWriter, ResolutionsAreTheFractionsOfShortDecimals) {
  using Fraction = std::vector<std::uint64_t>;
  EXPECT_EQ(tiff_resolution(1), (Fraction{1, 1}));
  EXPECT_EQ(tiff_resolution(0.957), (Fraction{1000, 957}));
  EXPECT_EQ(tiff_resolution(1.5), (Fraction{2, 3}));
  EXPECT_EQ(tiff_resolution(0.00065), (Fraction{20000, 13}));
  for (const double spacing : {3.14159265358979, 1e-7, 0.48828125, 12345.678, 1e-12, 1e12}) {
    const Fraction fraction = tiff_resolution(spacing);
    ASSERT_GE(fraction[0], 1u);
    ASSERT_GE(fraction[1], 1u);
    ASSERT_LE(std::max(fraction[0], fraction[1]), 4294967295u);
    if (spacing < 1e-9 || spacing > 1e9) continue;
    EXPECT_NEAR(double(fraction[1]) / double(fraction[0]) / spacing, 1, 1e-9) << spacing;
  }
}

TEST(UnitTiffWriter, SuppleReadsTheGeometryBackToTheBit) {
  const TemporaryFolder folder;
  const Geometry turned({3, 2, 2}, {-100.1, 20.3, 7},
                        {Vec3d(0.6, 0.8, 0) * 0.957, Vec3d(-0.8, 0.6, 0.1) * 0.3, {0, 0, -1.5}});
  for (const Geometry& geometry : {plain_grid({3, 2, 2}), turned}) {
    DenseImage image;
    image.geometry = geometry;
    image.type = ValueType::int16;
    const std::string bytes = counting_bytes(image);
    write_tiff_volume(folder / "a.tif", image, false, bytes);
    const auto file = open_volume(folder / "a.tif");
    EXPECT_EQ(file->header().geometry.axes_mm(), geometry.axes_mm());
    EXPECT_EQ(file->header().geometry.origin_lps_mm(), geometry.origin_lps_mm());
  }
}

TEST(UnitTiffWriter, SpacingThatAnotherProgramChangedCounts) {
  const TemporaryFolder folder;
  DenseImage image;
  image.geometry = Geometry({3, 2, 1}, {5, 6, 7}, {Vec3d(0.5, 0, 0), {0, 0.5, 0}, {0, 0, 1}});
  image.type = ValueType::uint8;
  write_tiff_volume(folder / "a.tif", image, false, "abcdef");
  TIFF* tiff = TIFFOpen((folder / "a.tif").c_str(), "r+");
  TIFFSetField(tiff, TIFFTAG_XRESOLUTION, 4.0);
  TIFFRewriteDirectory(tiff);
  TIFFClose(tiff);
  const auto file = open_volume(folder / "a.tif");
  EXPECT_EQ(file->header().geometry.spacing_mm(), Vec3d(0.25, 0.5, 1));
  EXPECT_EQ(file->header().geometry.origin_lps_mm(), Vec3d(0, 0, 0));
}

TEST(UnitTiffWriter, WhatOtherProgramsDoNotFindIsSaid) {
  const TemporaryFolder folder;
  const auto warning = [&](const Vec3d& origin, const std::array<Vec3d, 3>& axes) {
    DenseImage image;
    image.geometry = Geometry({1, 1, 1}, origin, axes);
    image.type = ValueType::uint8;
    const auto lines = write_tiff_volume(folder / "a.tif", image, false, "a");
    return lines.empty() ? "" : lines.at(0).substr(0, lines[0].find(" for supple"));
  };
  const std::array<Vec3d, 3> straight = {Vec3d(1, 0, 0), {0, 2, 0}, {0, 0, 3}};
  const std::array<Vec3d, 3> flipped = {Vec3d(1, 0, 0), {0, -2, 0}, {0, 0, 3}};
  EXPECT_EQ(warning({0, 0, 0}, straight), "");
  EXPECT_EQ(warning({0, 0, 1}, straight), "TIFF keeps the origin");
  EXPECT_EQ(warning({0, 0, 0}, flipped), "TIFF keeps the direction");
  EXPECT_EQ(warning({0, 0, 1}, flipped), "TIFF keeps the origin and direction");
}

TEST(FaultTiffWriter, VectorsAreRefused) {
  const TemporaryFolder folder;
  DenseImage image;
  image.geometry = plain_grid({2, 2, 2});
  image.components = 3;
  try {
    create_dense(folder / "warp.tif", image);
    ADD_FAILURE() << "vectors were taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("found vectors, expected scalars"), std::string::npos);
  }
  EXPECT_EQ(folder.entries().size(), 0u);
}

TEST(FaultTiffWriter, TooFewSlicesLeaveNoFile) {
  const TemporaryFolder folder;
  DenseImage image;
  image.geometry = plain_grid({1, 1, 2});
  image.type = ValueType::uint8;
  {
    const auto writer = create_dense(folder / "a.tif", image);
    writer->write_slice("a");
    EXPECT_THROW(writer->commit(), Error);
  }
  EXPECT_EQ(folder.entries().size(), 0u);
}

TEST(FaultTiffWriter, AFullDiskWhileCompressingIsASystemErrorAndLeavesNothing) {
  const TemporaryFolder folder;
  DenseImage image;
  image.geometry = plain_grid({300, 200, 3});
  image.type = ValueType::float32;
  std::string bytes(std::size_t(300) * 200 * 3 * 4, '\0');
  unsigned state = 1;
  for (char& byte : bytes) byte = char((state = state * 1664525u + 1013904223u) >> 24);
  for (const rlim_t limit : {0, 5, 1000, 300000, 700000}) {
    const FileSizeLimit full(limit);
    try {
      write_tiff_volume(folder / "a.tif", image, true, bytes);
      ADD_FAILURE() << "written in " << limit << " bytes";
    } catch (const SystemError& error) {
      EXPECT_NE(std::string(error.what()).find("a.tif: cannot write: File too large"),
                std::string::npos)
          << error.what();
    }
    EXPECT_EQ(folder.entries().size(), 0u);
  }
}

}  // namespace
