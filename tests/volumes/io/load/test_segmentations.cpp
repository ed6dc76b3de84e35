// Segmentations as 3D Slicer writes them (.seg.nrrd): names, layers, damage.
#include <gtest/gtest.h>

#include "tests/support/errors.h"
#include "tests/support/io_fixtures.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/label_file.h"

namespace supple::test {
namespace {

/// A grid of 4 x 1 x 1 voxels; layers lie together in each.
std::string segmentation(const std::string& voxels, int layers, const std::string& keys) {
  const bool is_layered = layers > 1;
  return "NRRD0004\n# Complete NRRD file format specification at:\n"
         "# http://teem.sourceforge.net/nrrd/format.html\ntype: unsigned char\ndimension: " +
         std::string(is_layered ? "4" : "3") + "\nspace: left-posterior-superior\nsizes: " +
         (is_layered ? std::to_string(layers) + " " : "") +
         "4 1 1\nspace directions: " + (is_layered ? "none " : "") +
         "(0.5,0,0) (0,0.5,0) (0,0,2)\nkinds: " + (is_layered ? "list " : "") +
         "domain domain domain\nencoding: raw\nspace origin: (1,2,3)\n" + keys +
         "Segmentation_ContainedRepresentationNames:=Binary labelmap|\n"
         "Segmentation_ReferenceImageExtentOffset:=0 0 0\n\n" +
         voxels;
}

std::string segment(int number, const std::string& name, int value, int layer) {
  const std::string prefix = "Segment" + std::to_string(number) + "_";
  return prefix + "Color:=0.5 0.8 0.5\n" + prefix + "Extent:=0 3 0 0 0 0\n" + prefix +
         "ID:=" + name + "_1\n" + prefix + "LabelValue:=" + std::to_string(value) + "\n" + prefix +
         "Layer:=" + std::to_string(layer) + "\n" + prefix + "Name:=" + name + "\n" + prefix +
         "Tags:=Segmentation.Status:inprogress|\n";
}

/// The labels of the four voxels.
std::vector<int> labels_of(VolumeFile& file) {
  EXPECT_EQ(file.header().type, ValueType::uint16);
  std::vector<std::uint16_t> values(4);
  file.read_slice(values.data());
  return {values.begin(), values.end()};
}

TEST(UnitSegmentations, OneLayerKeepsItsValuesAndNamesThem) {
  const TemporaryFolder folder;
  const std::string path =
      folder.write("a.seg.nrrd",
                   segmentation({0, 7, 3, 9}, 1, segment(10, "b c", 3, 0) + segment(2, "a", 7, 0)));
  const LabelNames expected = {{7, "a"}, {3, "b c"}};
  EXPECT_EQ(label_names(path), expected);
  const auto file = open_volume(path);
  EXPECT_EQ(file->header().type, ValueType::uint8);
  EXPECT_TRUE(file->header().warnings.empty());
  std::vector<char> values(4);
  file->read_slice(values.data());
  EXPECT_EQ(values, (std::vector<char>{0, 7, 3, 9}));
}

TEST(UnitSegmentations, OfOverlappingSegmentsTheLastOneCounts) {
  const TemporaryFolder folder;
  const std::string voxels = {0, 1, 1, 1, 2, 0, 0, 9};
  const std::string shared = segmentation(
      voxels, 2, segment(0, "head", 1, 0) + segment(1, "skull", 2, 0) + segment(2, "jaw", 1, 1));
  const auto file = open_volume(folder.write("a.seg.nrrd", shared));
  EXPECT_EQ(file->header().label_names, (LabelNames{{1, "head"}, {2, "skull"}, {3, "jaw"}}));
  ASSERT_EQ(file->header().warnings.size(), 1u);
  EXPECT_EQ(file->header().warnings[0],
            "2 layers of segments: where several segments hold a voxel the last of them counts");
  EXPECT_EQ(labels_of(*file), (std::vector<int>{3, 3, 2, 0}));
  // Values that no other segment has stay.
  const auto own = open_volume(
      folder.write("b.seg.nrrd", segmentation(voxels, 2,
                                              segment(0, "jaw", 9, 1) + segment(1, "head", 1, 0) +
                                                  segment(2, "skull", 2, 0))));
  EXPECT_EQ(labels_of(*own), (std::vector<int>{0, 1, 2, 9}));
  // A channel is one layer as it is stored.
  ReadOptions second;
  second.channel = 1;
  std::vector<char> values(4);
  open_volume(folder / "a.seg.nrrd", second)->read_slice(values.data());
  EXPECT_EQ(values, (std::vector<char>{1, 1, 0, 9}));
}

TEST(UnitSegmentations, SegmentsOfSlicer4AreTheOnesOfTheirLayers) {
  const TemporaryFolder folder;
  const auto file = open_volume(folder.write(
      "a.seg.nrrd",
      segmentation({0, 1, 1, 0, 0, 0, 1, 1}, 2, "Segment0_Name:=fat\nSegment1_Name:=bone\n")));
  EXPECT_EQ(labels_of(*file), (std::vector<int>{2, 1, 0, 2}));
}

TEST(UnitSegmentations, MoreLayersThanAVolumeHasComponentsAreRead) {
  const TemporaryFolder folder;
  std::string voxels(4 * 20, '\0'), keys;
  voxels[2 * 20 + 19] = 1;
  for (int n = 0; n < 20; ++n) keys += segment(n, "s" + std::to_string(n), 1, n);
  const auto file = open_volume(folder.write("a.seg.nrrd", segmentation(voxels, 20, keys)));
  EXPECT_EQ(labels_of(*file), (std::vector<int>{0, 0, 20, 0}));
}

TEST(UnitSegmentations, LabelsAreMeantByNumberOrByTheOnlySegmentOfAName) {
  const LabelNames names = {{1, "fat"}, {2, "bone"}, {3, "fat"}, {4, "7"}};
  EXPECT_EQ(find_label(names, "bone"), 2);
  EXPECT_EQ(find_label(names, "fat"), std::nullopt);
  EXPECT_EQ(find_label(names, "7"), 7);
  for (const char* none : {"07", "0", "65536", "-1", "", "3.0", "Bone"}) {
    EXPECT_EQ(find_label(names, none), std::nullopt) << none;
  }
  EXPECT_EQ(find_label(names, "65535"), 65535);
}

TEST(FaultSegmentations, ValuesAndLayersThatCannotBeAreNamed) {
  const TemporaryFolder folder;
  const auto open = [&](const std::string& keys) {
    const std::string path = folder.write("a.nrrd", segmentation(std::string(8, '\1'), 2, keys));
    return input_error([&] { open_volume(path); });
  };
  EXPECT_NE(open(segment(0, "a", 0, 0)).find("Segment0_LabelValue: found 0, expected 1 to 65535"),
            std::string::npos);
  EXPECT_NE(open(segment(3, "a", 1, 2)).find("Segment3_Layer: found 2, expected 0 to 1"),
            std::string::npos);
  EXPECT_EQ(label_names(folder / "none.nrrd"), LabelNames{});
  EXPECT_EQ(label_names(folder.path()), LabelNames{});
}

}  // namespace
}  // namespace supple::test
