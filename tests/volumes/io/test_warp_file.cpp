// Files of vectors, NRRD and MetaImage, written by hand as other programs write them.
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/io_fixtures.h"
#include "volumes/base/error.h"
#include "volumes/io/volume_writer.h"
#include "volumes/io/warp_file.h"

namespace supple::test {
namespace {

/// Three components of 3 x 2 x 2 voxels, all different.
std::vector<float> components() {
  std::vector<float> values;
  for (int n = 0; n < 36; ++n) values.push_back(0.25f * float(n) - 3);
  return values;
}

std::vector<Vec3f> vectors_of(const std::vector<float>& values) {
  std::vector<Vec3f> vectors;
  for (std::size_t n = 0; n < values.size(); n += 3) {
    vectors.emplace_back(values[n], values[n + 1], values[n + 2]);
  }
  return vectors;
}

const std::string kSpace =
    "space: left-posterior-superior\nspace directions: none (2,0,0) (0,3,0) (0,0.5,4)\n"
    "space origin: (10,20,-30)\n";
const std::string kKinds = "kinds: vector domain domain domain\n";

std::string warp_nrrd(const std::string& fields, const std::string& type = "float") {
  return "NRRD0005\ntype: " + type + "\ndimension: 4\nsizes: 3 3 2 2\nencoding: raw\n" + fields +
         (fields.find("endian") == std::string::npos ? "endian: little\n\n" : "\n");
}

std::string warp_metaimage(const std::string& fields) {
  return fields + "ObjectType = Image\nNDims = 3\nDimSize = 3 2 2\nElementType = MET_FLOAT\n" +
         "Offset = 1 2 3\nElementSpacing = 2 3 4\nElementNumberOfChannels = 3\n" +
         "ElementDataFile = LOCAL\n";
}

void expect_grid(const Geometry& geometry, const Vec3d& origin, const std::array<Vec3d, 3>& axes) {
  EXPECT_LT((geometry.origin_lps_mm() - origin).length(), 1e-12) << geometry.origin_lps_mm();
  for (int a = 0; a < 3; ++a) {
    EXPECT_LT((geometry.axes_mm()[a] - axes[a]).length(), 1e-12) << geometry.axes_mm()[a];
  }
}

void expect_refused(const std::string& path, const std::vector<std::string>& parts) {
  expect_parts(path, failure_of_warp(path), parts);
}

TEST(UnitWarpFile, NrrdVectorsComeWithTheirGridAndSayNoDirection) {
  const TemporaryFolder folder;
  const Warp warp =
      read_warp(folder.write("a.nrrd", warp_nrrd(kSpace + kKinds) + bytes_of_values(components())));
  EXPECT_EQ(warp.geometry.dims(), Vec3i(3, 2, 2));
  expect_grid(warp.geometry, {10, 20, -30}, {Vec3d(2, 0, 0), {0, 3, 0}, {0, 0.5, 4}});
  EXPECT_FALSE(warp.direction.has_value());
  EXPECT_EQ(warp.vectors, vectors_of(components()));
}

TEST(UnitWarpFile, EveryKindOfVectorCountsAndAMissingKindWithoutDirectionToo) {
  const TemporaryFolder folder;
  const std::string data = bytes_of_values(components());
  for (const char* kind : {"vector", "3-vector", "list", "none", "???"}) {
    const std::string kinds = std::string("kinds: ") + kind + " domain domain domain\n";
    EXPECT_EQ(failure_of_warp(folder.write("a.nrrd", warp_nrrd(kSpace + kinds) + data)), "")
        << kind;
  }
  EXPECT_EQ(failure_of_warp(folder.write("b.nrrd", warp_nrrd(kSpace) + data)), "");
  const Warp spaced = read_warp(
      folder.write("c.nrrd", warp_nrrd("kinds: vector space space space\nspacings: nan 2 3 4\n"
                                       "units: \"mm\" \"mm\" \"mm\" \"mm\"\n") +
                                 data));
  expect_grid(spaced.geometry, {0, 0, 0}, {Vec3d(2, 0, 0), {0, 3, 0}, {0, 0, 4}});
  EXPECT_EQ(spaced.vectors, vectors_of(components()));
}

TEST(UnitWarpFile, BigEndianGzippedDoublesAndIntegersRead) {
  const TemporaryFolder folder;
  const std::vector<float> values = components();
  const std::vector<double> doubles(values.begin(), values.end());
  std::string header = warp_nrrd(kSpace + kKinds + "endian: big\n", "double");
  header.replace(header.find("raw"), 3, "gzip");
  EXPECT_EQ(
      read_warp(folder.write("a.nrrd", header + gzip(bytes_of_values(doubles, true)))).vectors,
      vectors_of(values));
  std::vector<std::int16_t> shorts;
  for (int n = 0; n < 36; ++n) shorts.push_back(std::int16_t(n - 7));
  const Warp warp =
      read_warp(folder.write("b.nrrd", warp_nrrd(kSpace + kKinds + "endian: big\n", "short") +
                                           bytes_of_values(shorts, true)));
  EXPECT_EQ(warp.vectors[2], Vec3f(-1, 0, 1));
  EXPECT_EQ(warp.vectors[11], Vec3f(26, 27, 28));
}

TEST(UnitWarpFile, ARasSpaceFlipsTheGridButNotTheVectors) {
  const TemporaryFolder folder;
  const Warp warp = read_warp(folder.write(
      "a.nrrd", warp_nrrd("space: RAS\nspace directions: none (2,0,0) (0,3,0) (0,0,4)\n"
                          "space origin: (10,20,30)\n" +
                          kKinds) +
                    bytes_of_values(components())));
  expect_grid(warp.geometry, {-10, -20, 30}, {Vec3d(-2, 0, 0), {0, -3, 0}, {0, 0, 4}});
  EXPECT_EQ(warp.vectors, vectors_of(components()));
}

TEST(UnitWarpFile, MetaImageChannelsInBothByteOrdersAndCompressed) {
  const TemporaryFolder folder;
  const std::vector<float> values = components();
  const std::string paths[] = {
      folder.write("a.mha", warp_metaimage("") + bytes_of_values(values)),
      folder.write("b.mha", warp_metaimage("BinaryDataByteOrderMSB = True\n") +
                                bytes_of_values(values, true)),
      folder.write("c.mha", warp_metaimage("CompressedData = True\n") +
                                zlib_stream(bytes_of_values(values))),
      folder.write("d.mha", warp_metaimage("HeaderSize = -1\n") + "some other header" +
                                bytes_of_values(values))};
  for (const std::string& path : paths) {
    const Warp warp = read_warp(path);
    expect_grid(warp.geometry, {1, 2, 3}, {Vec3d(2, 0, 0), {0, 3, 0}, {0, 0, 4}});
    EXPECT_FALSE(warp.direction.has_value());
    EXPECT_EQ(warp.vectors, vectors_of(values)) << path;
  }
}

TEST(UnitWarpFile, WhatTheWriterWroteReadsBackWithItsDirection) {
  const TemporaryFolder folder;
  const Geometry grid({3, 2, 2}, {1.5, -2, 0.1}, {Vec3d(0, 0.5, 0), {-2, 0, 0}, {0, 0, 3}});
  const auto vectors = vectors_of(components());
  const auto slices = [&](int k, Vec3f* out) { std::copy_n(vectors.begin() + 6 * k, 6, out); };
  for (const WarpDirection direction : {WarpDirection::resample, WarpDirection::material}) {
    for (const char* name : {"a.nrrd", "a.nhdr", "a.mha", "a.mhd"}) {
      write_warp(folder / name, {grid, direction}, slices);
      const Warp warp = read_warp(folder / name);
      EXPECT_EQ(warp.geometry, grid) << name;
      EXPECT_EQ(warp.direction, direction) << name;
      EXPECT_EQ(warp.vectors, vectors) << name;
    }
  }
}

TEST(FaultWarpFile, SizesCountComponentsAndBothNumbersArePrinted) {
  const TemporaryFolder folder;
  const std::string data = bytes_of_values(components());
  expect_refused(folder.write("a.nrrd", warp_nrrd(kSpace + kKinds) + data.substr(1)),
                 {"143 bytes", "144 bytes"});
  expect_refused(folder.write("b.nrrd", warp_nrrd(kSpace + kKinds) + data + "x"),
                 {"145 bytes", "144 bytes"});
  expect_refused(folder.write("c.mha", warp_metaimage("") + data.substr(96)),
                 {"48 bytes", "144 bytes"});
}

TEST(FaultWarpFile, ScalarsAndVectorsAreNotMixedUp) {
  const TemporaryFolder folder;
  const std::string data = bytes_of_values(components());
  const std::vector<std::string> warps = {folder.write("a.nrrd", warp_nrrd(kSpace + kKinds) + data),
                                          folder.write("a.mha", warp_metaimage("") + data)};
  for (const std::string& path : warps) {
    const std::string line = failure_of(path);
    EXPECT_NE(line.find("found 3 components per voxel, expected a scalar volume, or channel 0 to "
                        "2; vectors are read as a warp"),
              std::string::npos)
        << line;
  }
  const std::string scalars =
      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 3 2 2\nencoding: raw\n\n";
  expect_refused(folder.write("s.nrrd", scalars + std::string(12, 'x')),
                 {"s.nrrd", "one component", "three components"});
  EXPECT_EQ(failure_of(folder / "s.nrrd"), "");
}

TEST(FaultWarpFile, WhatIsNoVectorOfThreeComponentsIsRefused) {
  const TemporaryFolder folder;
  const std::string data = bytes_of_values(components());
  const auto expect = [&](const std::string& fields, const std::vector<std::string>& parts) {
    expect_refused(folder.write("a.nrrd", warp_nrrd(fields) + data), parts);
  };
  expect(kSpace + "kinds: RGB-color domain domain domain\n", {"colours"});
  expect(kSpace + "kinds: vector domain\n", {"kinds", "one kind per axis"});
  expect("kinds: domain domain domain vector\n", {"2 components per voxel"});
  expect(kSpace + kKinds + "space units: \"cm\" \"cm\" \"cm\"\n", {"space units", "mm"});
  expect(kSpace + kKinds + "measurement frame: (0,1,0) (1,0,0) (0,0,1)\n", {"measurement frame"});
  expect(kSpace + kKinds + "supple direction:=sideways\n", {"direction", "sideways"});
  std::string two = warp_metaimage("");
  two.replace(two.find("Channels = 3"), 12, "Channels = 2");
  expect_refused(folder.write("a.mha", two + data.substr(48)), {"2 components per voxel"});
  EXPECT_EQ(failure_of_warp(
                folder.write("b.nrrd", warp_nrrd(kSpace + kKinds +
                                                 "measurement frame: (1,0,0) (0,1,0) (0,0,1)\n"
                                                 "space units: \"mm\" \"mm\" \"mm\"\n") +
                                           data)),
            "");
}

TEST(FaultWarpFile, VectorsThatAreNotFiniteAreCounted) {
  const TemporaryFolder folder;
  std::vector<float> values = components();
  values[4] = values[5] = std::numeric_limits<float>::quiet_NaN();
  values[30] = -std::numeric_limits<float>::infinity();
  expect_refused(folder.write("a.nrrd", warp_nrrd(kSpace + kKinds) + bytes_of_values(values)),
                 {"a.nrrd", "found 2 that are not finite"});
}

}  // namespace
}  // namespace supple::test
