// NIfTI beyond a single scalar volume: time series, vectors, colours.

#include "tests/volumes/io/nifti_fixtures.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/warp_file.h"

namespace supple::test {
namespace {

TEST(UnitNiftiSeries, EveryFrameIsReadFromItsPlacePlainAndGzipped) {
  const TemporaryFolder folder;
  const std::string bytes =
      nifti_header({3, 2, 2, 4}) + bytes_of_values(counted<std::int16_t>(48)) + "behind";
  for (const std::string& path :
       {folder.write("a.nii", bytes), folder.write("a.nii.gz", gzip(bytes))}) {
    for (int t = 0; t < 4; ++t) {
      EXPECT_EQ(values_of<std::int16_t>(path, frame(t)), counted<std::int16_t>(12, 12 * t)) << path;
    }
    expect_refused(path, {"dim[4]", "4 frames", "frame 0 to 3"});
    expect_refused(path, {"frame", "4", "0 to 3"}, frame(4));
  }
}

TEST(UnitNiftiSeries, AFrameOfVectorsTakesItsPartOfEveryComponent) {
  const TemporaryFolder folder;
  const std::string bytes = nifti_header_of({2, 1, 1, 2, 3}, 4, 16) +
                            bytes_of_values(std::vector<std::int16_t>{0, 1, 10, 11,      // x
                                                                      20, 21, 30, 31,    // y
                                                                      40, 41, 50, 51});  // z
  for (const std::string& path :
       {folder.write("a.nii", bytes), folder.write("a.nii.gz", gzip(bytes))}) {
    EXPECT_EQ(values_of<std::int16_t>(path, frame(0)),
              (std::vector<std::int16_t>{0, 20, 40, 1, 21, 41}));
    EXPECT_EQ(values_of<std::int16_t>(path, frame(1)),
              (std::vector<std::int16_t>{10, 30, 50, 11, 31, 51}));
  }
}

TEST(UnitNiftiVectors, ComponentsOfEveryWidthAndByteOrderComeTogether) {
  const TemporaryFolder folder;
  const auto expect = [&](auto zero, int datatype) {
    using T = decltype(zero);
    std::vector<T> planes, together;
    for (int c = 0; c < 5; ++c) {
      for (int n = 0; n < 8; ++n) planes.push_back(T(10 * c + n));
    }
    for (int n = 0; n < 8; ++n) {
      for (int c = 0; c < 5; ++c) together.push_back(T(10 * c + n));
    }
    const std::string header = nifti_header_of({2, 2, 2, 1, 5}, datatype, 8 * sizeof(T));
    const std::string path = folder.write("a.nii", header + bytes_of_values(planes));
    EXPECT_EQ(values_of<T>(path), together) << datatype;
    const std::string swapped =
        folder.write("b.nii", reversed_fields(header) + bytes_of_values(planes, true));
    EXPECT_EQ(values_of<T>(swapped), together) << datatype;
    ReadOptions third;
    third.channel = 3;
    EXPECT_EQ(values_of<T>(path, third), counted<T>(8, 30)) << datatype;
  };
  expect(std::int8_t(), 256);
  expect(std::uint8_t(), 2);
  expect(std::int16_t(), 4);
  expect(std::uint16_t(), 512);
  expect(std::int32_t(), 8);
  expect(std::uint32_t(), 768);
  expect(std::int64_t(), 1024);
  expect(std::uint64_t(), 1280);
  expect(float(), 16);
  expect(double(), 64);
}

TEST(UnitNiftiVectors, TheFrameOfTheVectorsFollowsTheIntent) {
  const TemporaryFolder folder;
  const std::string data = bytes_of_values(counted<float>(36, 1));
  const Vec3f second(2, 14, 26);
  for (const auto& [intent, sign] : {std::pair(1007, 1.0f), {0, 1.0f}, {1006, -1.0f}}) {
    const std::string path = folder.write("a.nii", warp_header(intent) + data);
    EXPECT_EQ(open_scalars_or_vectors(path)->header().vectors_in_ras, intent == 1006);
    const Warp warp = read_warp(path);
    EXPECT_EQ(warp.vectors[1], Vec3f(sign * second.x, sign * second.y, second.z)) << intent;
    EXPECT_FALSE(warp.direction.has_value());
  }
  std::string metres = warp_header(1007);
  metres[kUnits] = 1;
  expect_refused(folder.write("m.nii", metres + data), {"xyzt_units", "found 1", "mm"});
}

TEST(UnitNiftiVectors, ColoursAreThreeOrFourBytesWithoutScaling) {
  const TemporaryFolder folder;
  for (const auto& [datatype, count] : {std::pair(128, 3), {2304, 4}}) {
    std::string header = nifti_header_of({2, 1, 2}, datatype, 8 * count);
    patch(header, 112, 7.0f);
    const auto values = counted<std::uint8_t>(4 * count, 100);
    const auto path = folder.write("a.nii", header + bytes_of_values(values));
    const auto file = open_scalars_or_vectors(path);
    EXPECT_EQ(file->header().components, count);
    EXPECT_EQ(file->header().type, ValueType::uint8);
    EXPECT_EQ(file->header().slope, 1);
    EXPECT_EQ(values_of<std::uint8_t>(path), values);
  }
}

TEST(FaultNifti, WhatAFileCannotHoldIsRefusedBeforeAnyValue) {
  const TemporaryFolder folder;
  const std::string data = bytes_of_values(counted<float>(36));
  const auto expect = [&](const std::string& header, const std::vector<std::string>& parts,
                          const ReadOptions& options = {}) {
    expect_refused(folder.write("a.nii", header + data), parts, options);
  };
  expect(nifti_header_of({3, 2, 2}, 32, 64), {"datatype", "32"});  // complex
  expect(nifti_header_of({3, 2, 2}, 1792, 128), {"datatype", "1792"});
  expect(nifti_header_of({3, 2, 2}, 128, 32), {"bitpix", "32", "24"});
  expect(nifti_header_of({3, 2, 2, 1, 17}, 16, 32), {"dim[5]", "17", "1 to 16"});
  expect(nifti_header_of({3, 2, 2, 1, 1, 2}, 16, 32), {"dim[6]", "2"});
  expect(nifti_header_of({3, 2, 2, 1, 1, 1, 3}, 16, 32), {"dim[7]", "3"});
  expect(nifti_header_of({3, 2, 2, 1, 2}, 128, 24), {"dim[5]", "colour"});
  expect(nifti_header_of({3, 2, 2, 1, 4}, 16, 32), {"144 bytes", "192 bytes"});
  // The frame is there, but not all that the header claims.
  expect(nifti_header_of({3, 2, 2, 4}, 16, 32), {"144 bytes", "192 bytes"}, frame(0));
  expect_refused(folder.write("b.nii.gz", gzip(warp_header(1007) + data.substr(4))),
                 {"compressed data"});
  expect_refused(folder.write("s.nii", nifti_header_of({3, 2, 2, 1, 2}, 16, 32) + data), {},
                 frame(1));
}

}  // namespace
}  // namespace supple::test
