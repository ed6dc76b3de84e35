// Label volumes in any order (stored_labels.h), from files written here.
#include <gtest/gtest.h>

#include "tests/support/io_fixtures.h"
#include "volumes/base/error.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/stored_labels.h"

namespace supple::test {
namespace {

std::string label_nrrd(const std::string& type, const std::string& sizes,
                       const std::string& bytes) {
  return "NRRD0004\ntype: " + type +
         "\ndimension: 3\nspace: left-posterior-superior\nsizes: " + sizes +
         "\nspace directions: (2,0,0) (0,1,0) (0,0,3)\nspace origin: (10,0,0)\nendian: little\n"
         "encoding: raw\n\n" +
         bytes;
}

StoredLabels stored_labels(const TemporaryFolder& folder, const std::string& content) {
  const auto file = open_volume(folder.write("l.nrrd", content));
  return StoredLabels(*file);
}

std::int16_t label_at(const StoredLabels& labels, const Vec3d& lps_mm) {
  std::int16_t value = -1;
  labels.nearest(lps_mm, reinterpret_cast<char*>(&value));
  return value;
}

/// 11 x 9 x 10 voxels with a value of its own each, but zeros beyond i = 7.
std::vector<std::int16_t> numbered() {
  std::vector<std::int16_t> values;
  for (int n = 0; n < 11 * 9 * 10; ++n) values.push_back(n % 11 > 7 ? 0 : std::int16_t(n + 1));
  return values;
}

TEST(UnitStoredLabels, EveryPlaceReadsItsNearestVoxelAndZeroBeyondTheBox) {
  const TemporaryFolder folder;
  const StoredLabels labels =
      stored_labels(folder, label_nrrd("int16", "11 9 10", bytes_of_values(numbered())));
  for (int k = 0; k < 10; ++k) {
    for (int j = 0; j < 9; ++j) {
      for (int i = 0; i < 11; ++i) {
        const int expected = i > 7 ? 0 : (k * 9 + j) * 11 + i + 1;
        const Vec3d centre(10 + 2 * i, j, 3 * k);
        EXPECT_EQ(label_at(labels, centre), expected);
        EXPECT_EQ(label_at(labels, centre + Vec3d(-0.9, 0.4, 1.4)), expected);
        EXPECT_EQ(label_at(labels, centre + Vec3d(1, 0.5, 1.5)), expected) << "half way";
      }
    }
  }
  EXPECT_EQ(label_at(labels, {9, -0.5, -1.5}), 1);
  EXPECT_EQ(label_at(labels, {8.9, 0, 0}), 0);
  EXPECT_EQ(label_at(labels, {10, 0, 28.6}), 0);
  EXPECT_EQ(label_at(labels, {1e300, 0, 0}), 0);
}

TEST(UnitStoredLabels, LabelsAreCountedByValue) {
  const TemporaryFolder folder;
  const StoredLabels labels = stored_labels(
      folder,
      label_nrrd("int16", "2 2 2", bytes_of_values<std::int16_t>({7, 7, 0, -3, 7, 0, 0, 7})));
  EXPECT_EQ(labels.counts(), (LabelCounts{{-3, 1}, {7, 4}}));
}

TEST(FaultStoredLabels, ValuesThatAreNoLabelsAreNamed) {
  const TemporaryFolder folder;
  const auto error_of = [&](const std::string& content) -> std::string {
    try {
      stored_labels(folder, content);
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_EQ(error_of(label_nrrd("float", "1 1 2", bytes_of_values<float>({1, 2}))), "none");
  EXPECT_NE(error_of(label_nrrd("float", "1 2 1", bytes_of_values<float>({1, 1.5f})))
                .find("voxel 0,1,0: found 1.5, expected a label: a whole number"),
            std::string::npos);
  EXPECT_NE(error_of(label_nrrd("float", "1 1 1", bytes_of_values<float>({NAN}))).find("nan"),
            std::string::npos);
  std::string nifti = nifti_header({1, 1, 1});
  patch<float>(nifti, 112, 2);
  const auto file = open_volume(folder.write("l.nii", nifti + std::string(2, '\1')));
  EXPECT_THROW(StoredLabels{*file}, InputError) << "a slope";
}

}  // namespace
}  // namespace supple::test
