// Components and frames wherever a header puts them: the chosen frame and channel, value for value.
#include <gtest/gtest.h>

#include "tests/support/io_fixtures.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {
namespace {

// Value of voxel (i, j, k), component c, frame f; 2 x 3 x 2 voxels, 3 components, 4 frames.
constexpr int kSize[] = {3, 2, 3, 2, 4};  // c i j k f
std::int16_t value(int c, int i, int j, int k, int f) {
  return std::int16_t(c + 10 * i + 100 * j + 1000 * k + 5000 * f);
}

/// Values with the axes in this order, fastest first, such as "cijkf"; axes left out are at 0.
std::string stored(const std::string& order) {
  const std::string names = "cijkf";
  std::vector<std::int16_t> values;
  std::size_t count = 1;
  for (const char axis : order) count *= std::size_t(kSize[names.find(axis)]);
  for (std::size_t n = 0; n < count; ++n) {
    int at[5] = {0, 0, 0, 0, 0};
    std::size_t rest = n;
    for (const char axis : order) {
      const std::size_t which = names.find(axis), size = std::size_t(kSize[which]);
      at[which] = int(rest % size);
      rest /= size;
    }
    values.push_back(value(at[0], at[1], at[2], at[3], at[4]));
  }
  return bytes_of_values(values);
}

/// Every kind and every size in the order of `order`.
std::string frames_nrrd(const std::string& order, const std::string& encoding = "raw",
                        const std::string& frame_kind = "time") {
  const std::string names = "cijkf";
  std::string sizes, kinds, directions;
  for (const char axis : order) {
    sizes += " " + std::to_string(kSize[names.find(axis)]);
    kinds += axis == 'c' ? " vector" : axis == 'f' ? " " + frame_kind : " domain";
    directions += axis == 'i'   ? " (1,0,0)"
                  : axis == 'j' ? " (0,1,0)"
                  : axis == 'k' ? " (0,0,1)"
                                : " none";
  }
  return "NRRD0005\ntype: short\ndimension: " + std::to_string(order.size()) + "\nsizes:" + sizes +
         "\nkinds:" + kinds + "\nspace: LPS\nspace directions:" + directions +
         "\nendian: little\nencoding: " + encoding + "\n\n";
}

std::string expected(int frame, int channel) {
  std::vector<std::int16_t> values;
  for (int k = 0; k < 2; ++k) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 2; ++i) values.push_back(value(channel, i, j, k, frame));
    }
  }
  return bytes_of_values(values);
}

/// Frame by frame and channel by channel, where the file has them.
void expect_all_read(const std::string& path, int frames, int channels) {
  for (int f = 0; f < frames; ++f) {
    for (int c = 0; c < channels; ++c) {
      const auto file = open_volume(path, choice(frames > 1 ? std::optional(f) : std::nullopt,
                                                 channels > 1 ? std::optional(c) : std::nullopt));
      EXPECT_EQ(file->header().geometry.dims(), Vec3i(2, 3, 2)) << path;
      EXPECT_EQ(read_all(*file), expected(f, c)) << path << " frame " << f << " channel " << c;
    }
  }
}

TEST(PropertyFrames, EveryOrderOfAxesGivesTheSameVolumes) {
  const TemporaryFolder folder;
  for (const char* order : {"cijk", "icjk", "ijck", "ijkc"}) {
    expect_all_read(folder.write("a.nrrd", frames_nrrd(order) + stored(order)), 1, 3);
  }
  for (const char* order : {"ijkf", "ijfk", "ifjk", "fijk"}) {
    expect_all_read(folder.write("a.nrrd", frames_nrrd(order) + stored(order)), 4, 1);
  }
  for (const char* order : {"cijkf", "ijkcf", "ijkfc", "fcijk", "icjfk", "fijkc", "cfijk"}) {
    expect_all_read(folder.write("a.nrrd", frames_nrrd(order) + stored(order)), 4, 3);
  }
}

TEST(PropertyFrames, CompressedFramesAreTheSame) {
  const TemporaryFolder folder;
  for (const char* order : {"ijkf", "ijkfc", "ijkcf"}) {
    const int channels = std::string(order).size() == 4 ? 1 : 3;
    expect_all_read(folder.write("a.nrrd", frames_nrrd(order, "gzip") + gzip(stored(order))), 4,
                    channels);
  }
}

TEST(UnitFrames, ALastAxisWithoutKindOrDirectionIsATimeSeries) {
  const TemporaryFolder folder;
  const std::string spaced =
      "NRRD0004\ntype: short\ndimension: 4\nsizes: 2 3 2 4\nspacings: 1 1 1 0.5\nendian: little\n"
      "encoding: raw\n\n";
  expect_all_read(folder.write("a.nrrd", spaced + stored("ijkf")), 4, 1);
  for (const char* kind : {"list", "none", "domain", "???"}) {
    expect_all_read(folder.write("a.nrrd", frames_nrrd("ijkf", "raw", kind) + stored("ijkf")), 4,
                    1);
  }
}

TEST(UnitFrames, SpacesWithTimeGiveFramesAndAGeometryWithoutIt) {
  const TemporaryFolder folder;
  for (const char* space : {"left-posterior-superior-time", "LPST"}) {
    const std::string path = folder.write(
        "a.nrrd", std::string("NRRD0005\ntype: short\ndimension: 4\nsizes: 2 3 2 4\nspace: ") +
                      space +
                      "\nspace directions: (2,0,0,0) (0,3,0,0) (0,0,4,0) (0,0,0,0.5)\n"
                      "space origin: (5,6,7,0)\nspace units: \"mm\" \"mm\" \"mm\" \"s\"\n"
                      "endian: little\nencoding: raw\n\n" +
                      stored("ijkf"));
    expect_all_read(path, 4, 1);
    const Geometry geometry = open_volume(path, choice(0))->header().geometry;
    EXPECT_EQ(geometry.origin_lps_mm(), Vec3d(5, 6, 7));
    EXPECT_EQ(geometry.axes_mm()[1], Vec3d(0, 3, 0));
  }
}

TEST(UnitFrames, AShortListOnTheFirstAxisHoldsChannelsAndALongOneFrames) {
  const TemporaryFolder folder;
  const auto series = [&](int count) {
    std::vector<std::uint8_t> values;
    for (int n = 0; n < 4 * count; ++n) values.push_back(std::uint8_t(n % count));
    return folder.write("a.nrrd",
                        "NRRD0004\ntype: uchar\ndimension: 4\nsizes: " + std::to_string(count) +
                            " 2 2 1\nkinds: list domain domain domain\nencoding: raw\n\n" +
                            bytes_of_values(values));
  };
  EXPECT_EQ(read_all(*open_volume(series(16), choice({}, 15))), std::string(4, char(15)));
  EXPECT_EQ(read_all(*open_volume(series(17), choice(16))), std::string(4, char(16)));
}

TEST(UnitFrames, ColoursAreComponents) {
  const TemporaryFolder folder;
  const std::string path =
      folder.write("a.nrrd",
                   "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 2 1\n"
                   "kinds: RGBA-color domain domain\nencoding: raw\n\nrgbaRGBA");
  EXPECT_EQ(open_scalars_or_vectors(path)->header().components, 4);
  EXPECT_EQ(read_all(*open_volume(path, choice({}, 2))), "bB");
}

TEST(UnitFrames, MetaImageTakesTheFourthDimensionForTimeAndArraysForChannels) {
  const TemporaryFolder folder;
  const std::string head =
      "NDims = 4\nDimSize = 2 3 2 4\nElementSpacing = 1 2 3 0.5\nOffset = 4 5 6 0\n"
      "TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\nAnatomicalOrientation = ASL?\n";
  const std::string path = folder.write(
      "a.mha", head + "ElementType = MET_SHORT\nElementDataFile = LOCAL\n" + stored("ijkf"));
  expect_all_read(path, 4, 1);
  const Geometry geometry = open_volume(path, choice(0))->header().geometry;
  EXPECT_EQ(geometry.origin_lps_mm(), Vec3d(4, 5, 6));
  EXPECT_EQ(geometry.spacing_mm(), Vec3d(1, 2, 3));
  expect_all_read(
      folder.write("b.mha", head +
                                "ElementNumberOfChannels = 3\nElementType = MET_SHORT_ARRAY\n"
                                "CompressedData = True\nElementDataFile = LOCAL\n" +
                                zlib_stream(stored("cijkf"))),
      4, 3);
}

TEST(UnitFrames, FramesInFilesOfTheirOwnAreReadAlone) {
  const TemporaryFolder folder;
  const std::string all = stored("ijkf");
  for (int f = 0; f < 4; ++f) {
    folder.write("f" + std::to_string(f), all.substr(std::size_t(f) * 24, 24));
  }
  std::string head = frames_nrrd("ijkf");
  head.insert(head.size() - 1, "data file: f%d 0 3 1\n");
  expect_all_read(folder.write("a.nhdr", head), 4, 1);
  expect_all_read(folder.write("a.mhd",
                               "NDims = 4\nDimSize = 2 3 2 4\nElementType = MET_SHORT\n"
                               "ElementDataFile = f%d 0 3 1\n"),
                  4, 1);
}

TEST(FaultFrames, SeriesWithoutAChoiceAndChoicesBeyondTheSeriesAreRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a.nrrd", frames_nrrd("ijkf") + stored("ijkf"));
  expect_failure(path, {"sizes", "4 frames", "frame 0 to 3"}, choice({}));
  expect_failure(path, {"frame", "4", "0 to 3"}, choice(4));
  expect_failure(path, {"frame", "-1"}, choice(-1));
  const std::string single = folder.write("b.nrrd", frames_nrrd("ijk") + stored("ijk"));
  expect_failure(single, {"frame", "1", "0, the only one"}, choice(1));
}

TEST(FaultFrames, AxesThatMakeNoVolumeAreRefused) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& fields, const std::vector<std::string>& parts) {
    expect_failure(folder.write("a.nrrd", "NRRD0005\ntype: uchar\nencoding: raw\n" + fields + "\n" +
                                              std::string(64, 'x')),
                   parts, choice(0));
  };
  expect("dimension: 5\nsizes: 2 2 2 2 4\n", {"sizes", "one axis of frames"});
  expect("dimension: 4\nsizes: 2 2 4 4\nkinds: vector vector domain domain\n",
         {"one axis of components"});
  expect("dimension: 3\nsizes: 32 2 1\nkinds: vector domain domain\n", {"at most 16 components"});
  expect("dimension: 3\nsizes: 4 4 4\nkinds: RGB-color domain domain\n", {"kinds", "size 3"});
  expect("dimension: 3\nsizes: 4 4 4\nkinds: colour domain domain\n", {"kinds", "colour"});
  expect("dimension: 2\nsizes: 2 32\nkinds: list domain\n", {"lattice of 2 or 3 axes"});
  expect("dimension: 3\nsizes: 4 4 4\nspace: LPST\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n",
         {"space directions", "4 components"});
  expect(
      "dimension: 3\nsizes: 4 4 4\nspace: LPST\nspace directions: (1,0,0,1) (0,1,0,0) (0,0,1,0)\n",
      {"space directions", "in space or in time"});
  expect("dimension: 3\nsizes: 4 4 4\ntype: block\n", {"type", "twice"});
}

TEST(FaultFrames, ATruncatedSeriesIsRefusedWhicheverFrameIsChosen) {
  const TemporaryFolder folder;
  const std::string all = stored("ijkf");
  const std::string plain = folder.write("a.nrrd", frames_nrrd("ijkf") + all.substr(1));
  const std::string packed =
      folder.write("b.nrrd", frames_nrrd("ijkf", "gzip") + gzip(all.substr(0, all.size() - 2)));
  for (int f = 0; f < 4; ++f) {
    expect_failure(plain, {"95 bytes", "96 bytes"}, choice(f));
    expect_failure(packed, {"94 bytes", "96 bytes"}, choice(f));
  }
}

}  // namespace
}  // namespace supple::test
