// NIfTI and GIPL headers patched byte by byte; PNG and TIFF images written by their own libraries.
#include <cmath>

#include <gtest/gtest.h>
#include <png.h>

#include "tests/support/io_fixtures.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"

namespace supple::test {
namespace {

void expect_nearly(const Vec3d& found, const Vec3d& expected) {
  EXPECT_LT((found - expected).length(), 1e-6) << found << " instead of " << expected;
}

std::string with_sform(std::string header) {
  const float rows[12] = {2, 0, 0, 10, 0, 3, 0.5f, 20, 0, 0, 4, 30};
  patch(header, 254, std::int16_t(1));
  for (std::size_t n = 0; n < 12; ++n) patch(header, 280 + 4 * n, rows[n]);
  return header;
}

std::string with_qform(std::string header) {
  patch(header, 252, std::int16_t(1));
  patch(header, 76, -1.0f);                   // qfac: k runs the other way
  patch(header, 256, 0.0f);                   // b
  patch(header, 260, 0.0f);                   // c
  patch(header, 264, float(std::sqrt(0.5)));  // d: a quarter turn about z
  for (int a = 0; a < 3; ++a) patch(header, 80 + 4 * a, float(a + 2));
  for (int a = 0; a < 3; ++a) patch(header, 268 + 4 * a, float(10 * (a + 1)));
  return header;
}

void put(std::string& header, std::size_t offset, const std::string& big_endian) {
  header.replace(offset, big_endian.size(), big_endian);
}

/// 3 x 2 x 2 voxels of 0.5 x 1 x 2 mm, int16, one frame.
std::string gipl_header() {
  std::string header(256, '\0');
  put(header, 0, bytes_of_values(std::vector<std::uint16_t>{3, 2, 2, 0, 15}, true));
  put(header, 10, bytes_of_values(std::vector<float>{0.5f, 1, 2, 1}, true));
  put(header, 204, bytes_of_values(std::vector<double>{-10, 20, 30.5}, true));
  put(header, 252, bytes_of_value(std::uint32_t(719555000), true));
  return header;
}

TEST(UnitGipl, SpacingAndOriginAreReadAlongLps) {
  const TemporaryFolder folder;
  const auto file =
      open_volume(folder.write("a.bin", gipl_header() + bytes_of_values(kShorts, true)));
  const Geometry& geometry = file->header().geometry;
  EXPECT_EQ(file->header().format, "gipl");
  EXPECT_EQ(geometry.dims(), Vec3i(3, 2, 2));
  expect_nearly(geometry.origin_lps_mm(), {-10, 20, 30.5});
  expect_nearly(geometry.axes_mm()[0], {0.5, 0, 0});
  expect_nearly(geometry.axes_mm()[1], {0, 1, 0});
  expect_nearly(geometry.axes_mm()[2], {0, 0, 2});
  EXPECT_EQ(read_all(*file), bytes_of_values(kShorts));
}

TEST(UnitGipl, AFrameOfATimeSeriesIsChosen) {
  const TemporaryFolder folder;
  std::string header = gipl_header();
  put(header, 6, bytes_of_value(std::uint16_t(2), true));
  const std::string path =
      folder.write("a.gipl", header + std::string(24, '\7') + bytes_of_values(kShorts, true));
  EXPECT_EQ(read_all(*open_volume(path, choice(1))), bytes_of_values(kShorts));
  expect_failure(path, {"a.gipl", "dim[3]"});
}

TEST(UnitGipl, DamagedHeadersNameFieldAndValue) {
  const TemporaryFolder folder;
  const auto refuses = [&](std::size_t offset, const std::string& bytes,
                           const std::vector<std::string>& parts) {
    std::string header = gipl_header();
    put(header, offset, bytes);
    expect_failure(folder.write("a.gipl", header + bytes_of_values(kShorts, true)), parts);
  };
  refuses(2, std::string(2, '\0'), {"dim[1]", "0"});
  refuses(8, bytes_of_value(std::uint16_t(192), true), {"image type", "192"});
  refuses(14, bytes_of_value(-1.0f, true), {"pixdim[1]", "-1"});
  refuses(204, bytes_of_value(std::nan(""), true), {"a.gipl", "nan"});
  refuses(252, std::string(4, '\0'), {"magic"});
  refuses(4, bytes_of_value(std::uint16_t(65535), true), {"a.gipl"});
  expect_failure(folder.write("b.gipl", gipl_header().substr(0, 100)), {"100 bytes", "256 bytes"});
}

TEST(UnitNifti, SformBecomesLps) {
  const TemporaryFolder folder;
  const auto file = open_volume(
      folder.write("a.nii", with_sform(nifti_header({3, 2, 2})) + bytes_of_values(kShorts)));
  const Geometry& geometry = file->header().geometry;
  EXPECT_EQ(file->header().format, "nifti");
  EXPECT_EQ(geometry.dims(), Vec3i(3, 2, 2));
  expect_nearly(geometry.origin_lps_mm(), {-10, -20, 30});
  expect_nearly(geometry.axes_mm()[0], {-2, 0, 0});
  expect_nearly(geometry.axes_mm()[1], {0, -3, 0});
  expect_nearly(geometry.axes_mm()[2], {0, -0.5, 4});
  EXPECT_EQ(read_all(*file), bytes_of_values(kShorts));
}

TEST(UnitNifti, QformTurnsByItsQuaternion) {
  const TemporaryFolder folder;
  const auto file = open_volume(
      folder.write("a.nii", with_qform(nifti_header({3, 2, 2})) + bytes_of_values(kShorts)));
  const Geometry& geometry = file->header().geometry;
  expect_nearly(geometry.origin_lps_mm(), {-10, -20, 30});
  expect_nearly(geometry.axes_mm()[0], {0, -2, 0});  // RAS (0, 2, 0)
  expect_nearly(geometry.axes_mm()[1], {3, 0, 0});   // RAS (-3, 0, 0)
  expect_nearly(geometry.axes_mm()[2], {0, 0, -4});
}

TEST(UnitNifti, SformGoesBeforeQform) {
  const TemporaryFolder folder;
  const auto file = open_volume(folder.write(
      "a.nii", with_sform(with_qform(nifti_header({3, 2, 2}))) + bytes_of_values(kShorts)));
  expect_nearly(file->header().geometry.axes_mm()[0], {-2, 0, 0});
}

TEST(UnitNifti, UnitsOfMetresAndMicronsBecomeMillimetres) {
  const TemporaryFolder folder;
  std::string header = nifti_header({3, 2, 2});
  header[123] = 3;
  const auto file = open_volume(folder.write("a.nii", header + bytes_of_values(kShorts)));
  expect_nearly(file->header().geometry.spacing_mm(), {0.001, 0.001, 0.001});
}

TEST(UnitNifti, GzippedWithSlopeInterceptAndBytesBehind) {
  const TemporaryFolder folder;
  std::string header = nifti_header({3, 2, 2, 1, 1});
  patch(header, 112, 0.5f);
  patch(header, 116, 100.0f);
  const auto path = folder.write("a.nii.gz", gzip(header + bytes_of_values(kShorts) + "padding"));
  const auto file = open_volume(path);
  EXPECT_EQ(file->header().slope, 0.5);
  EXPECT_EQ(read_all(*file), bytes_of_values(kShorts));
  const VolumeDigest digest = digest_volume(*open_volume(path));
  EXPECT_EQ(digest.statistics.min, -50);
  EXPECT_EQ(digest.statistics.max, 250);
}

TEST(UnitNifti, SlopeOfZeroMeansNoScaling) {
  const TemporaryFolder folder;
  std::string header = nifti_header({3, 2, 2});
  patch(header, 116, 100.0f);
  const auto file = open_volume(folder.write("a.nii", header + bytes_of_values(kShorts)));
  EXPECT_EQ(file->header().slope, 1);
  EXPECT_EQ(file->header().intercept, 0);
}

TEST(UnitNifti, PairOfFilesOpensByEitherName) {
  const TemporaryFolder folder;
  std::string header = nifti_header({3, 2, 2}).substr(0, 348);
  patch(header, 108, 0.0f);
  std::memcpy(header.data() + 344, "ni1", 4);
  folder.write("a.hdr", header);
  folder.write("a.img.gz", gzip(bytes_of_values(kShorts)));
  for (const char* name : {"a.hdr", "a.img.gz"}) {
    EXPECT_EQ(read_all(folder / name), bytes_of_values(kShorts)) << name;
  }
}

TEST(UnitNifti, BigEndianHeaderAndValues) {
  const TemporaryFolder folder;
  std::string header(352, '\0');
  const auto put = [&](std::size_t offset, auto value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    for (std::size_t n = 0; n < sizeof value; ++n) header[offset + n] = bytes[sizeof value - 1 - n];
  };
  put(0, std::int32_t(348));
  const std::int16_t dims[4] = {3, 3, 2, 2};
  for (std::size_t a = 0; a < 4; ++a) put(40 + 2 * a, dims[a]);
  put(70, std::int16_t(4));
  put(72, std::int16_t(16));
  for (std::size_t a = 1; a < 4; ++a) put(76 + 4 * a, float(a));
  put(108, 352.0f);
  std::memcpy(header.data() + 344, "n+1", 4);
  const auto file = open_volume(folder.write("a.nii", header + bytes_of_values(kShorts, true)));
  expect_nearly(file->header().geometry.spacing_mm(), {1, 2, 3});
  EXPECT_EQ(read_all(*file), bytes_of_values(kShorts));
}

TEST(UnitNifti, SecondVersionOfTheHeader) {
  const TemporaryFolder folder;
  std::string header(544, '\0');
  patch(header, 0, std::int32_t(540));
  std::memcpy(header.data() + 4, "n+2\0\r\n\032\n", 8);
  patch(header, 12, std::int16_t(4));
  patch(header, 14, std::int16_t(16));
  const std::int64_t dims[4] = {3, 3, 2, 2};
  std::memcpy(header.data() + 16, dims, sizeof dims);
  for (std::size_t a = 1; a < 4; ++a) patch(header, 104 + 8 * a, double(a));
  patch(header, 168, std::int64_t(544));
  const auto file = open_volume(folder.write("a.nii", header + bytes_of_values(kShorts)));
  expect_nearly(file->header().geometry.axes_mm()[1], {0, -2, 0});
  EXPECT_EQ(read_all(*file), bytes_of_values(kShorts));
}

TEST(UnitPng, EightAndSixteenBitsAndInterlaced) {
  const TemporaryFolder folder;
  const std::string bytes = std::string("\x00\x01\x7f\x80\xfe\xff", 6);
  for (const bool interlaced : {false, true}) {
    write_png(folder / "a.png", 3, 2, 8, PNG_COLOR_TYPE_GRAY, bytes, interlaced);
    const auto file = open_volume(folder / "a.png");
    EXPECT_EQ(file->header().format, "png");
    EXPECT_EQ(file->header().geometry.dims(), Vec3i(3, 2, 1));
    expect_nearly(file->header().geometry.axes_mm()[1], {0, 1, 0});
    EXPECT_EQ(read_all(*file), bytes);
  }
  const std::vector<std::uint16_t> deep = {0, 1, 256, 65535, 4660, 255};
  write_png(folder / "b.png", 2, 3, 16, PNG_COLOR_TYPE_GRAY, bytes_of_values(deep, true));
  const auto file = open_volume(folder / "b.png");
  EXPECT_EQ(file->header().type, ValueType::uint16);
  EXPECT_EQ(read_all(*file), bytes_of_values(deep));
}

TEST(UnitPng, SingleBitsAreStretchedToEight) {
  const TemporaryFolder folder;
  write_png(folder / "a.png", 4, 1, 1, PNG_COLOR_TYPE_GRAY, std::string("\xa0", 1));
  EXPECT_EQ(read_all(folder / "a.png"), std::string("\xff\0\xff\0", 4));
}

TEST(UnitTiff, StripsTilesCompressionByteOrdersAndBigTiff) {
  const TemporaryFolder folder;
  std::vector<std::uint16_t> values(37 * 21);
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = std::uint16_t(n * 77);
  for (const int tile : {0, 16}) {
    for (const int compression : {1, 8}) {
      for (const char* mode : {"wl", "wb", "w8"}) {
        TiffOptions options;
        options.bits = 16;
        options.tile = tile;
        options.compression = compression;
        options.mode = mode;
        write_tiff(folder / "a.tif", 37, 21, options, bytes_of_values(values));
        const auto file = open_volume(folder / "a.tif");
        EXPECT_EQ(file->header().format, "tiff");
        EXPECT_EQ(file->header().geometry.dims(), Vec3i(37, 21, 1));
        EXPECT_EQ(read_all(*file), bytes_of_values(values)) << tile << compression << mode;
      }
    }
  }
}

TEST(UnitTiff, FloatsAndMinIsWhite) {
  const TemporaryFolder folder;
  TiffOptions options;
  options.bits = 32;
  options.sample_format = 3;
  const std::vector<float> floats = {-1.5f, 0, 2.25f, 1e6f};
  write_tiff(folder / "f.tif", 2, 2, options, bytes_of_values(floats));
  const auto file = open_volume(folder / "f.tif");
  EXPECT_EQ(file->header().type, ValueType::float32);
  EXPECT_EQ(read_all(*file), bytes_of_values(floats));

  TiffOptions white;
  white.photometric = 0;
  write_tiff(folder / "w.tif", 2, 1, white, std::string("\x0a\xff", 2));
  const Volume volume = load_volume(folder / "w.tif");
  EXPECT_EQ(volume.statistics.min, 0);
  EXPECT_EQ(volume.statistics.max, 245);
  EXPECT_EQ(volume.density.at({0, 0, 0}), 245);
}

}  // namespace
}  // namespace supple::test
