// Folders and patterns of PNG and TIFF images, one per slice.
#include <filesystem>

#include <gtest/gtest.h>
#include <png.h>

#include "tests/support/io_fixtures.h"
#include "volumes/base/error.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {
namespace {

/// A folder with one-pixel images, TIFF or PNG by the name's end, of the values given.
class SeriesFolder {
 public:
  SeriesFolder() { std::filesystem::create_directory(path()); }
  std::string path() const { return m_root / "series"; }
  std::string operator/(const std::string& name) const { return path() + "/" + name; }
  void add(const std::string& name, char value, int width = 1, TiffOptions options = {}) const {
    const std::string rows(std::size_t(width * options.bits / 8), value);
    if (name.back() == 'g') {
      write_png(*this / name, width, 1, 8, PNG_COLOR_TYPE_GRAY, rows);
    } else {
      write_tiff(*this / name, width, 1, options, rows);
    }
  }
  void add_text(const std::string& name, const std::string& text) const {
    m_root.write("series/" + name, text);
  }

 private:
  TemporaryFolder m_root;
};

TEST(UnitSeries, SlicesAreSortedByTheirNumbers) {
  for (const char* extension : {".tif", ".PNG.png", ".tiff"}) {
    const SeriesFolder folder;
    for (const int n : {10, 2, 1, 9, 3, 4, 5, 6, 7, 8}) {
      folder.add("s" + std::to_string(n) + extension, char('a' + n));
    }
    const auto file = open_volume(folder.path());
    EXPECT_EQ(file->header().geometry.dims(), Vec3i(1, 1, 10));
    EXPECT_TRUE(file->header().warnings.empty());
    EXPECT_EQ(read_all(*file), "bcdefghijk") << extension;
  }
}

TEST(UnitSeries, HiddenAndForeignFilesArePassedOver) {
  const SeriesFolder folder;
  folder.add("a1.tif", 'a');
  folder.add("a2.TIF", 'b');
  folder.add(".a3.tif", 'x');
  folder.add_text("notes.txt", "text");
  folder.add_text("Thumbs.db", "more");
  std::filesystem::create_directory(folder / "a4.tif");
  EXPECT_EQ(read_all(*open_volume(folder.path())), "ab");
}

TEST(UnitSeries, PatternsNameTheFilesOfOneSeries) {
  const SeriesFolder folder;
  const std::vector<std::pair<std::string, char>> files = {
      {"s_0009.tif", 'a'}, {"s_0010.tif", 'b'}, {"s_11.tif", 'x'}, {"s_00012.tif", 'x'},
      {"s_13_.tif", 'x'},  {"t_0001.tif", 'x'}, {"s_8.tif", 'c'},  {"s_12345.tif", 'd'}};
  for (const auto& [name, value] : files) folder.add(name, value);
  EXPECT_EQ(read_all(folder / "s_%04d.tif"), "abd");
  EXPECT_EQ(read_all(folder / "s_%d.tif"), "cxd");
  expect_failure(folder / "u_%04d.tif", {"u_%04d.tif", "no file of such a name"});
  folder.add("s_%d.tif", 'q');
  EXPECT_EQ(read_all(folder / "s_%d.tif"), "q");
}

TEST(UnitSeries, MissingNumbersAreAWarningAndEvenStepsAreNot) {
  const SeriesFolder folder, even;
  for (const int n : {1, 2, 5, 6, 9}) folder.add("s" + std::to_string(n) + ".tif", 'a');
  const auto warnings = open_volume(folder.path())->header().warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].find("4 slices are missing"), 0u) << warnings[0];
  EXPECT_NE(warnings[0].find("s2.tif and s5.tif"), std::string::npos) << warnings[0];
  for (const int n : {1, 6, 11}) even.add("s" + std::to_string(n) + ".tif", 'a');
  EXPECT_TRUE(open_volume(even.path())->header().warnings.empty());
}

TEST(UnitSeries, SpacingAndChannelsAreThoseOfTheImages) {
  const SeriesFolder folder;
  TiffOptions options;
  options.samples = 3;
  options.photometric = 2;
  options.x_resolution = options.y_resolution = 20;
  options.resolution_unit = 3;
  write_tiff(folder / "a1.tif", 1, 1, options, "rgb");
  write_tiff(folder / "a2.tif", 1, 1, options, "RGB");
  ReadOptions green;
  green.channel = 1;
  const auto file = open_volume(folder.path(), green);
  EXPECT_EQ(file->header().geometry.spacing_mm(), Vec3d(0.5, 0.5, 1));
  EXPECT_EQ(file->header().warnings.size(), 1u);  // the distance of slices
  EXPECT_EQ(read_all(*file), "gG");
}

TEST(FaultSeries, ImagesThatDifferFromTheFirstAreNamed) {
  TiffOptions deep, white;
  deep.bits = 16;
  white.photometric = 0;
  const std::vector<std::tuple<int, TiffOptions, std::string>> others = {
      {2, {}, "2 x 1 uint8"}, {1, deep, "1 x 1 uint16"}, {1, white, "MinIsWhite"}};
  for (const auto& [width, options, words] : others) {
    const SeriesFolder folder;
    folder.add("a1.tif", 'a');
    folder.add("a2.tif", 'b', width, options);
    expect_failure(folder.path(), {"a2.tif", words, "1 x 1 uint8 as in a1.tif"});
  }
}

TEST(FaultSeries, FoldersWithoutOneSeriesAreRefused) {
  const SeriesFolder empty, mixed, pages, damaged;
  empty.add_text("notes.txt", "text");
  expect_failure(empty.path(), {"a directory without images", "TIFF or PNG"});
  mixed.add("a.png", 'a');
  mixed.add("b.tif", 'b');
  expect_failure(mixed.path(), {"a.png and b.tif"});
  TiffOptions page;
  pages.add("a.tif", 'a');
  page.mode = "a";
  pages.add("a.tif", 'b', 1, page);
  expect_failure(pages.path(), {"a.tif", "TIFF pages", "one image"});
  damaged.add("a1.tif", 'a');
  damaged.add_text("a2.tif", "no image");
  expect_failure(damaged.path(), {"a2.tif", "TIFF"});
  ReadOptions second;
  second.frame = 1;
  damaged.add("a2.tif", 'b');
  EXPECT_NE(failure_of(damaged.path(), second).find("frame"), std::string::npos);
}

}  // namespace
}  // namespace supple::test
