// Raw, NRRD and MetaImage headers computed by hand.
#include <gtest/gtest.h>

#include "tests/support/io_fixtures.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"

namespace supple::test {
namespace {

std::string commented_nrrd(const std::string& fields) {
  return "NRRD0004\n# a comment\ntype: short\nkey:=value\n" + fields + "\n";
}

void expect_near(const Vec3d& found, const Vec3d& expected) {
  EXPECT_LT((found - expected).length(), 1e-9) << found << " instead of " << expected;
}

void expect_axes(const VolumeFile& file, const Vec3d& origin, const std::array<Vec3d, 3>& axes) {
  expect_near(file.header().geometry.origin_lps_mm(), origin);
  for (int a = 0; a < 3; ++a) expect_near(file.header().geometry.axes_mm()[a], axes[a]);
}

TEST(UnitRaw, SpecGivesDimsTypeSpacingEndianAndOffset) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a.raw", "12345" + bytes_of_values(kShorts, true));
  const auto file =
      open_volume(path, {"dims=3,2,2,type=int16,spacing=0.5,1,2.5,endian=big,offset=5"});
  EXPECT_EQ(file->header().format, "raw");
  EXPECT_EQ(file->header().geometry.dims(), Vec3i(3, 2, 2));
  expect_axes(*file, {0, 0, 0}, {Vec3d(0.5, 0, 0), {0, 1, 0}, {0, 0, 2.5}});
  EXPECT_EQ(read_all(*file), bytes_of_values(kShorts));
}

TEST(UnitRaw, TwoDimsMakeOneSlice) {
  const TemporaryFolder folder;
  const auto file = open_volume(folder.write("a.raw", bytes_of_values(kShorts)),
                                {"type=int16,dims=4,3,spacing=1,2"});
  EXPECT_EQ(file->header().geometry.dims(), Vec3i(4, 3, 1));
}

TEST(UnitNrrd, AttachedRawWithLpsDirections) {
  const TemporaryFolder folder;
  const auto file = open_volume(folder.write(
      "a.nrrd", commented_nrrd("dimension: 3\nsizes: 3 2 2\nspace: left-posterior-superior\n"
                               "space directions: (0,2,0) (-1,0,0) (0,0.5,3)\n"
                               "space origin: (10,20,-30)\nencoding: raw\nendian: little\n") +
                    bytes_of_values(kShorts)));
  EXPECT_EQ(file->header().format, "nrrd");
  EXPECT_EQ(file->header().type, ValueType::int16);
  expect_axes(*file, {10, 20, -30}, {Vec3d(0, 2, 0), {-1, 0, 0}, {0, 0.5, 3}});
  EXPECT_EQ(read_all(*file), bytes_of_values(kShorts));
}

TEST(UnitNrrd, RasAndLasSpacesBecomeLps) {
  const TemporaryFolder folder;
  const std::string rest =
      "dimension: 3\nsizes: 3 2 2\nspace directions: (1,2,3) (0,4,0) (0,0,5)\n"
      "space origin: (10,20,30)\nencoding: raw\nendian: little\nspace: ";
  const std::string data = bytes_of_values(kShorts);
  const auto ras = open_volume(
      folder.write("r.nrrd", commented_nrrd(rest + "right-anterior-superior\n") + data));
  expect_axes(*ras, {-10, -20, 30}, {Vec3d(-1, -2, 3), {0, -4, 0}, {0, 0, 5}});
  const auto las = open_volume(folder.write("l.nrrd", commented_nrrd(rest + "LAS\n") + data));
  expect_axes(*las, {10, -20, 30}, {Vec3d(1, -2, 3), {0, -4, 0}, {0, 0, 5}});
}

TEST(UnitNrrd, DetachedGzipBigEndian) {
  const TemporaryFolder folder;
  folder.write("values.raw.gz", gzip(bytes_of_values(kShorts, true)));
  const auto file = open_volume(folder.write(
      "a.nhdr",
      commented_nrrd("dimension: 3\nsizes: 2 3 2\nspacings: 1 2 3\nencoding: gzip\nendian: big\n"
                     "data file: values.raw.gz\n")));
  expect_axes(*file, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 2, 0}, {0, 0, 3}});
  EXPECT_EQ(read_all(*file), bytes_of_values(kShorts));
}

TEST(UnitNrrd, GzipOfSeveralMembersReadsAsOneStream) {
  const TemporaryFolder folder;
  const std::string all = bytes_of_values(kShorts);
  const auto file = open_volume(folder.write(
      "a.nrrd", commented_nrrd("dimension: 3\nsizes: 2 3 2\nencoding: gz\nendian: little\n") +
                    gzip(all.substr(0, 7)) + gzip(all.substr(7))));
  EXPECT_EQ(read_all(*file), all);
}

TEST(UnitNrrd, AxisMinsAreTheFirstCellsEdge) {
  const TemporaryFolder folder;
  const auto file = open_volume(folder.write(
      "a.nrrd", commented_nrrd("dimension: 3\nsizes: 2 3 2\nspacings: 1 2 3\naxis mins: 0 10 -6\n"
                               "centers: node cell cell\nencoding: raw\nendian: little\n") +
                    bytes_of_values(kShorts)));
  expect_near(file->header().geometry.origin_lps_mm(), {0, 11, -4.5});
}

TEST(UnitNrrd, SingleAxisWithoutDirectionIsDropped) {
  const TemporaryFolder folder;
  const auto file = open_volume(folder.write(
      "a.nrrd", commented_nrrd("dimension: 4\nsizes: 1 2 3 2\nspace: LPS\n"
                               "space directions: none (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\n"
                               "endian: little\n") +
                    bytes_of_values(kShorts)));
  EXPECT_EQ(file->header().geometry.dims(), Vec3i(2, 3, 2));
}

TEST(UnitNrrd, ByteSkipOfMinusOneTakesTheEndOfTheFile) {
  const TemporaryFolder folder;
  folder.write("b.raw", "some other header" + bytes_of_values(kShorts));
  const auto file = open_volume(folder.write(
      "a.nhdr",
      commented_nrrd("dimension: 3\nsizes: 2 3 2\nencoding: raw\nendian: little\nbyte skip: -1\n"
                     "data file: b.raw\n")));
  EXPECT_EQ(read_all(*file), bytes_of_values(kShorts));
}

TEST(UnitMetaImage, LocalDataWithMatrixSpacingAndOffset) {
  const TemporaryFolder folder;
  const auto file = open_volume(
      folder.write("a.mha",
                   "ObjectType = Image\nNDims = 3\nDimSize = 3 2 2\nElementType = MET_SHORT\n"
                   "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 1 2 3\nElementSpacing = 2 3 4\n"
                   "ElementByteOrderMSB = False\nMyOwnKey = ignored\nElementDataFile = LOCAL\n" +
                       bytes_of_values(kShorts)));
  EXPECT_EQ(file->header().format, "metaimage");
  expect_axes(*file, {1, 2, 3}, {Vec3d(0, 2, 0), {-3, 0, 0}, {0, 0, 4}});
  EXPECT_EQ(read_all(*file), bytes_of_values(kShorts));
}

TEST(UnitMetaImage, CompressedBigEndianWithSlope) {
  const TemporaryFolder folder;
  folder.write("a.zraw", zlib_stream(bytes_of_values(kShorts, true)));
  const auto file = open_volume(
      folder.write("a.mhd",
                   "ObjectType = Image\nNDims = 3\nDimSize = 3 2 2\nElementType = MET_SHORT\n"
                   "CompressedData = True\nBinaryDataByteOrderMSB = True\n"
                   "ElementToIntensityFunctionSlope = 2\nElementToIntensityFunctionOffset = -1\n"
                   "ElementDataFile = a.zraw\n"));
  EXPECT_EQ(file->header().slope, 2);
  EXPECT_EQ(file->header().intercept, -1);
  EXPECT_EQ(read_all(*file), bytes_of_values(kShorts));
}

TEST(UnitMetaImage, HeaderSizeOfMinusOneTakesTheEndOfTheFile) {
  const TemporaryFolder folder;
  folder.write("a.bin", "junk before" + bytes_of_values(kShorts));
  const auto file = open_volume(
      folder.write("a.mhd",
                   "NDims = 2\r\nDimSize = 4 3\r\nElementType = MET_SHORT\r\nHeaderSize = -1\r\n"
                   "ElementDataFile = a.bin\r\n"));
  EXPECT_EQ(file->header().geometry.dims(), Vec3i(4, 3, 1));
  EXPECT_EQ(read_all(*file), bytes_of_values(kShorts));
}

/// Reads one value of a type back through `--raw`, NRRD and MetaImage.
template <class T>
void expect_type(ValueType type, const std::string& nrrd_name, const std::string& meta_name) {
  const TemporaryFolder folder;
  const std::vector<T> values = {T(1), T(-1), T(100), T(3)};
  const std::string name = numpy_name(type), data = bytes_of_values(values, true);
  std::vector<std::string> paths = {folder.write("a.raw", data)};
  paths.push_back(folder.write("a.nrrd", "NRRD0005\ntype: " + nrrd_name +
                                             "\ndimension: 2\nsizes: 2 2\nendian: big\n"
                                             "encoding: raw\n\n" +
                                             data));
  if (!meta_name.empty()) {
    paths.push_back(folder.write("a.mha",
                                 "NDims = 2\nDimSize = 2 2\nElementByteOrderMSB = True\n"
                                 "ElementType = " +
                                     meta_name + "\nElementDataFile = LOCAL\n" + data));
  }
  for (const std::string& path : paths) {
    const bool raw = path == paths[0];
    const auto file =
        open_volume(path, {raw ? "dims=2,2,spacing=1,1,endian=big,type=" + name : ""});
    EXPECT_EQ(file->header().type, type) << path << " " << name;
    EXPECT_EQ(read_all(*file), bytes_of_values(values)) << path << " " << name;
    const VolumeDigest digest = digest_volume(
        *open_volume(path, {raw ? "dims=2,2,spacing=1,1,endian=big,type=" + name : ""}));
    EXPECT_EQ(digest.statistics.min, std::min(double(T(-1)), 1.0)) << name;
    EXPECT_EQ(digest.statistics.max, std::max(double(T(-1)), 100.0)) << name;
  }
}

TEST(UnitTypes, EveryTypeReadsInBothTextFormatsAndRaw) {
  expect_type<std::int8_t>(ValueType::int8, "signed char", "MET_CHAR");
  expect_type<std::uint8_t>(ValueType::uint8, "uchar", "MET_UCHAR");
  expect_type<std::int16_t>(ValueType::int16, "short", "MET_SHORT");
  expect_type<std::uint16_t>(ValueType::uint16, "uint16_t", "MET_USHORT");
  expect_type<std::int32_t>(ValueType::int32, "int", "MET_LONG");
  expect_type<std::uint32_t>(ValueType::uint32, "unsigned int", "MET_UINT");
  expect_type<std::int64_t>(ValueType::int64, "long long int", "MET_LONG_LONG");
  expect_type<std::uint64_t>(ValueType::uint64, "uint64", "MET_ULONG_LONG");
  expect_type<float>(ValueType::float32, "float", "MET_FLOAT");
  expect_type<double>(ValueType::float64, "double", "MET_DOUBLE");
}

}  // namespace
}  // namespace supple::test
