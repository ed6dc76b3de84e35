// NIfTI beyond a single scalar volume: time series, vectors, colours, extensions, two affines that
// disagree, pairs whose magic and name differ. All files are patched byte by byte.
#include <limits>

#include <gtest/gtest.h>

#include "tests/volumes/io/io_fixtures.h"
#include "volumes/base/error.h"
#include "volumes/io/formats.h"
#include "volumes/io/warp_file.h"

namespace supple::test {
namespace {

constexpr std::size_t kIntent = 68, kDatatype = 70, kBitpix = 72, kOffset = 108, kUnits = 123;

template <class T>
std::vector<T> counted(int count, int first = 0) {
  std::vector<T> values;
  for (int n = 0; n < count; ++n) values.push_back(T(first + n));
  return values;
}

std::string header_of(const std::vector<int>& dims, int datatype, int bits, int intent = 0) {
  std::string header = nifti_header(dims);
  patch(header, kDatatype, std::int16_t(datatype));
  patch(header, kBitpix, std::int16_t(bits));
  patch(header, kIntent, std::int16_t(intent));
  return header;
}

/// All slices with their components together.
std::string all_slices(VolumeFile& file) {
  const Vec3i& dims = file.header().geometry.dims();
  const std::size_t slice = std::size_t(stored_bytes(file.header())) / std::size_t(dims.z);
  std::string bytes(slice * std::size_t(dims.z), '\0');
  for (int k = 0; k < dims.z; ++k) file.read_slice(bytes.data() + slice * std::size_t(k));
  return bytes;
}

template <class T>
std::vector<T> values_of(const std::string& path, const ReadOptions& options = {}) {
  const auto file = open_scalars_or_vectors(path, options);
  const std::string bytes = all_slices(*file);
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

ReadOptions frame(int number) {
  ReadOptions options;
  options.frame = number;
  return options;
}

std::string failure(const std::string& path, const ReadOptions& options = {}) {
  try {
    all_slices(*open_scalars_or_vectors(path, options));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_refused(const std::string& path, const std::vector<std::string>& parts,
                    const ReadOptions& options = {}) {
  const std::string line = failure(path, options);
  EXPECT_NE(line, "") << path << " was read";
  for (const std::string& part : parts) {
    EXPECT_NE(line.find(part), std::string::npos) << "\"" << part << "\" in: " << line;
  }
}

/// esize, ecode and the text, padded to a multiple of 16.
std::string extension(std::int32_t code, std::string text) {
  while ((8 + text.size()) % 16 != 0) text += '\0';
  std::string head(8, '\0');
  patch(head, 0, std::int32_t(8 + text.size()));
  patch(head, 4, code);
  return head + text;
}

std::string with_extensions(std::string header, const std::string& extensions) {
  header[348] = 1;
  patch(header, kOffset, float(352 + extensions.size()));
  return header + extensions;
}

/// Three components of 3 x 2 x 2 voxels, slowest.
const std::vector<int> kWarpDims = {3, 2, 2, 1, 3};
std::string warp_header(int intent) {
  return header_of(kWarpDims, 16, 32, intent);
}

TEST(UnitNiftiSeries, EveryFrameIsReadFromItsPlacePlainAndGzipped) {
  const TemporaryFolder folder;
  const std::string bytes =
      nifti_header({3, 2, 2, 4}) + bytes_of_values(counted<std::int16_t>(48)) + "behind";
  for (const std::string& path :
       {folder.write("a.nii", bytes), folder.write("a.nii.gz", gzip(bytes))}) {
    for (int t = 0; t < 4; ++t) {
      EXPECT_EQ(values_of<std::int16_t>(path, frame(t)), counted<std::int16_t>(12, 12 * t)) << path;
    }
    expect_refused(path, {"dim[4]", "4 frames", "--frame 0 to 3"});
    expect_refused(path, {"--frame", "4", "0 to 3"}, frame(4));
  }
}

TEST(UnitNiftiSeries, AFrameOfVectorsTakesItsPartOfEveryComponent) {
  const TemporaryFolder folder;
  const std::string bytes = header_of({2, 1, 1, 2, 3}, 4, 16) +
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
    const std::string header = header_of({2, 2, 2, 1, 5}, datatype, 8 * sizeof(T));
    const std::string path = folder.write("a.nii", header + bytes_of_values(planes));
    EXPECT_EQ(values_of<T>(path), together) << datatype;
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
    std::string header = header_of({2, 1, 2}, datatype, 8 * count);
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

TEST(UnitNiftiExtension, OurCommentSaysDirectionAndCertificateAndOthersArePassedOver) {
  const TemporaryFolder folder;
  const std::string comment =
      "supple direction: material\nsupple certificate: {\"folded\":0}\nand more\n";
  const std::string bytes =
      with_extensions(warp_header(1007), extension(2, "supple direction: resample\n") +
                                             extension(6, comment) + extension(4, "<xml/>")) +
      bytes_of_values(counted<float>(36));
  for (const std::string& path :
       {folder.write("a.nii", bytes), folder.write("a.nii.gz", gzip(bytes))}) {
    const auto file = open_scalars_or_vectors(path);
    EXPECT_EQ(file->header().warp_direction, "material");
    EXPECT_EQ(file->header().certificate, "{\"folded\":0}");
    EXPECT_TRUE(file->header().warnings.empty());
    EXPECT_EQ(read_warp(path).vectors[1], Vec3f(1, 13, 25));
  }
}

TEST(FaultNifti, ADamagedExtensionIsAWarningAndTheValuesStay) {
  const TemporaryFolder folder;
  const std::string sound = extension(6, "supple direction: material\n");
  for (const std::int32_t size : {0, -16, 7, 64, std::numeric_limits<std::int32_t>::max()}) {
    std::string damaged = extension(6, "supple direction: resample\n");
    patch(damaged, 0, size);
    const auto path = folder.write("a.nii", with_extensions(warp_header(1007), sound + damaged) +
                                                bytes_of_values(counted<float>(36)));
    const auto file = open_scalars_or_vectors(path);
    EXPECT_EQ(file->header().warp_direction, "material") << size;
    ASSERT_EQ(file->header().warnings.size(), 1u) << size;
    EXPECT_EQ(file->header().warnings[0],
              "damaged header extension at byte 400; it and those behind it are left out");
    EXPECT_EQ(read_warp(path).vectors[1], Vec3f(1, 13, 25));
  }
}

TEST(UnitNiftiExtension, OneOfSeveralMegabytesIsPassedOver) {
  const TemporaryFolder folder;
  const std::string large = extension(2, std::string(3 << 20, 'x'));
  const auto path = folder.write(
      "a.nii", with_extensions(warp_header(1007), large) + bytes_of_values(counted<float>(36)));
  const auto file = open_scalars_or_vectors(path);
  EXPECT_TRUE(file->header().warnings.empty());
  EXPECT_EQ(read_warp(path).vectors[1], Vec3f(1, 13, 25));
}

/// sform of 1 mm, and a qform shifted by `shift` mm along x.
std::string with_both_forms(double shift) {
  std::string header = nifti_header({3, 2, 2});
  patch(header, 76, 1.0f);
  patch(header, 252, std::int16_t(1));
  patch(header, 254, std::int16_t(1));
  patch(header, 268, float(shift));
  for (int a = 0; a < 3; ++a) patch(header, std::size_t(280 + 20 * a), 1.0f);
  return header;
}

TEST(UnitNiftiForms, SformAndQformThatDisagreeAreAWarning) {
  const TemporaryFolder folder;
  const std::string data = bytes_of_values(counted<std::int16_t>(12));
  const auto warnings = [&](const std::string& header) {
    return open_volume(folder.write("a.nii", header + data))->header().warnings;
  };
  EXPECT_TRUE(warnings(with_both_forms(0.04)).empty());
  const std::vector<std::string> expected = {
      "sform and qform disagree by 0.06 voxels; sform is used"};
  EXPECT_EQ(warnings(with_both_forms(0.06)), expected);
  std::string unset = with_both_forms(5);
  patch(unset, 252, std::int16_t(0));
  EXPECT_TRUE(warnings(unset).empty());

  std::string scaled = with_both_forms(0);
  patch(scaled, 84, 2.0f);  // of the qform alone; the far corner is one voxel off
  EXPECT_EQ(warnings(scaled)[0], "sform and qform disagree by 1 voxels; sform is used");
  std::string broken = with_both_forms(0);
  patch(broken, 84, 0.0f);
  EXPECT_EQ(warnings(broken)[0], "the qform is no grid; sform is used");
}

TEST(UnitNiftiPair, TheContentDecidesWhereMagicAndNameDiffer) {
  const TemporaryFolder folder;
  const std::string data = bytes_of_values(counted<std::int16_t>(12));
  const std::string single = nifti_header({3, 2, 2});
  std::string pair = single;
  std::memcpy(pair.data() + 344, "ni1", 4);

  folder.write("a.img", data);
  for (const std::string& header : {single, single.substr(0, 348), pair.substr(0, 348)}) {
    std::string start = header;
    if (header[345] == 'i') patch(start, kOffset, 0.0f);
    EXPECT_EQ(values_of<std::int16_t>(folder.write("a.hdr", start)), counted<std::int16_t>(12));
  }
  EXPECT_EQ(values_of<std::int16_t>(folder.write("b.hdr", single + data)),
            counted<std::int16_t>(12));
  EXPECT_EQ(values_of<std::int16_t>(folder.write("c.nii", pair + data)), counted<std::int16_t>(12));
  patch(pair, kOffset, 0.0f);
  expect_refused(folder.write("d.nii", pair + data), {"d.nii", "magic", ".img"});
}

TEST(FaultNifti, WhatAFileCannotHoldIsRefusedBeforeAnyValue) {
  const TemporaryFolder folder;
  const std::string data = bytes_of_values(counted<float>(36));
  const auto expect = [&](const std::string& header, const std::vector<std::string>& parts,
                          const ReadOptions& options = {}) {
    expect_refused(folder.write("a.nii", header + data), parts, options);
  };
  expect(header_of({3, 2, 2}, 32, 64), {"datatype", "32"});  // complex
  expect(header_of({3, 2, 2}, 1792, 128), {"datatype", "1792"});
  expect(header_of({3, 2, 2}, 128, 32), {"bitpix", "32", "24"});
  expect(header_of({3, 2, 2, 1, 17}, 16, 32), {"dim[5]", "17", "1 to 16"});
  expect(header_of({3, 2, 2, 1, 1, 2}, 16, 32), {"dim[6]", "2"});
  expect(header_of({3, 2, 2, 1, 1, 1, 3}, 16, 32), {"dim[7]", "3"});
  expect(header_of({3, 2, 2, 1, 2}, 128, 24), {"dim[5]", "colour"});
  expect(header_of({3, 2, 2, 1, 4}, 16, 32), {"144 bytes", "192 bytes"});
  // The frame is there, but not all that the header claims.
  expect(header_of({3, 2, 2, 4}, 16, 32), {"144 bytes", "192 bytes"}, frame(0));
  expect_refused(folder.write("b.nii.gz", gzip(warp_header(1007) + data.substr(4))),
                 {"compressed data"});
  expect_refused(folder.write("s.nii", header_of({3, 2, 2, 1, 2}, 16, 32) + data), {}, frame(1));
}

}  // namespace
}  // namespace supple::test
