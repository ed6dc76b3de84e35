// TIFF files that are damaged, that mix pages, or whose description counts other pages.
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/volumes/io/tiff_fixtures.h"
#include "volumes/base/error.h"

namespace supple::test {
namespace {

std::string contents(const std::string& path) {
  std::string bytes(std::filesystem::file_size(path), '\0');
  std::FILE* file = std::fopen(path.c_str(), "rb");
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file));
  std::fclose(file);
  return bytes;
}

template <class T>
T number_at(const std::string& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// Offset of the directory's link to the next one in a little-endian file.
std::size_t link_of(const std::string& bytes, std::size_t directory) {
  return directory + 2 + 12 * std::size_t(number_at<std::uint16_t>(bytes, directory));
}
std::size_t first_directory(const std::string& bytes) {
  return number_at<std::uint32_t>(bytes, 4);
}

/// Offset of the value of a tag in the first directory, which becomes a 32-bit one.
std::size_t value_of(std::string& bytes, int tag) {
  const std::size_t directory = first_directory(bytes);
  for (std::size_t at = directory + 2; at < link_of(bytes, directory); at += 12) {
    if (number_at<std::uint16_t>(bytes, at) != tag) continue;
    patch(bytes, at + 2, std::uint16_t(4));
    return at + 8;
  }
  throw std::logic_error("no such tag");
}

std::string sound_pages(const TemporaryFolder& folder, int count) {
  write_tiff_pages(folder / "sound.tif", 4, 3, TiffOptions(), lettered_pages(count, 12));
  return contents(folder / "sound.tif");
}

TEST(FaultTiff, DirectoriesThatComeBackToThemselvesAreAnErrorAndNoLoop) {
  const TemporaryFolder folder;
  const std::string sound = sound_pages(folder, 3);
  const std::size_t first = first_directory(sound);
  const std::size_t second = number_at<std::uint32_t>(sound, link_of(sound, first));
  const std::size_t third = number_at<std::uint32_t>(sound, link_of(sound, second));
  for (const auto& [from, to] :
       {std::pair(first, first), {second, first}, {third, second}, {third, third}}) {
    std::string bytes = sound;
    patch(bytes, link_of(sound, from), std::uint32_t(to));
    expect_failure(folder.write("loop.tif", bytes),
                   {"loop.tif", "earlier one", "a chain that ends"});
  }
}

TEST(FaultTiff, DirectoriesOutsideTheFileAreErrors) {
  const TemporaryFolder folder;
  const std::string sound = sound_pages(folder, 2);
  for (const std::uint32_t to : {std::uint32_t(sound.size()), 0xfffffff0u, 0xffffffffu}) {
    std::string bytes = sound;
    patch(bytes, link_of(sound, first_directory(sound)), to);
    expect_failure(folder.write("far.tif", bytes), {"TIFF director"});
    patch(bytes, 4, to);
    expect_failure(folder.write("far.tif", bytes), {"TIFF director"});
  }
  std::string none = sound;
  patch(none, 4, std::uint32_t(0));
  expect_failure(folder.write("none.tif", none), {"TIFF pages", "none"});
}

TEST(FaultTiff, CutOffFilesAreErrorsWhereverTheyEnd) {
  const TemporaryFolder folder;
  const std::string sound = sound_pages(folder, 2);
  for (std::size_t size = 4; size < sound.size(); ++size) {
    expect_failure(folder.write("cut.tif", sound.substr(0, size)), {"cut.tif"});
  }
}

TEST(FaultTiff, MixedPagesNameThePageAndBothKinds) {
  const TemporaryFolder folder;
  const auto mixed = [&](int width, TiffOptions other) {
    const TiffOptions page;
    write_tiff_pages(folder / "a.tif", 4, 3, page, lettered_pages(2, 12));
    other.mode = "a";
    write_tiff(folder / "a.tif", width, 3, other, std::string(96, 'x'));
    return folder / "a.tif";
  };
  TiffOptions deep, white, colour;
  deep.bits = 16;
  white.photometric = 0;
  colour.samples = 3;
  colour.photometric = 2;
  expect_failure(mixed(5, {}), {"TIFF page 3", "5 x 3 uint8", "4 x 3 uint8"});
  expect_failure(mixed(4, deep), {"TIFF page 3", "4 x 3 uint16", "4 x 3 uint8"});
  expect_failure(mixed(4, white), {"TIFF page 3", "MinIsWhite"});
  expect_failure(mixed(4, colour), {"TIFF page 3", "3 samples"});
}

TEST(FaultTiff, SizesThatTheFileCannotHoldAreRefusedBeforeAnythingIsAllocated) {
  const TemporaryFolder folder;
  for (const int compression : {1, 8}) {
    TiffOptions options;
    options.compression = compression;
    write_tiff(folder / "sound.tif", 4, 3, options, std::string(12, 'a'));
    std::string bytes = contents(folder / "sound.tif");
    patch(bytes, value_of(bytes, 256), std::uint32_t(0x7fffffff));
    expect_failure(folder.write("huge.tif", bytes), {"huge.tif", "file length"});
    patch(bytes, value_of(bytes, 256), std::uint32_t(0xffffffff));
    expect_failure(folder.write("huge.tif", bytes), {"image size", "4294967295"});
    patch(bytes, value_of(bytes, 257), std::uint32_t(0xffffffff));
    expect_failure(folder.write("huge.tif", bytes), {"huge.tif"});
  }
}

TEST(FaultTiff, ImageJDescriptionsThatCountOtherPagesAreErrors) {
  const TemporaryFolder folder;
  const auto stack = [&](const std::string& lines, int pages) {
    TiffOptions options;
    options.description = "ImageJ=1.53t\n" + lines;
    write_tiff_pages(folder / "a.tif", 4, 3, options, lettered_pages(pages, 12));
    return folder / "a.tif";
  };
  expect_failure(stack("images=4\nslices=4\n", 3), {"ImageDescription", "4 images", "3 as"});
  expect_failure(stack("images=6\nslices=3\nframes=4\n", 6), {"12 images", "6 as"});
  expect_failure(stack("images=2000000000\nslices=2000000000\n", 1), {"file length"});
  expect_failure(stack("images=3\nslices=2\n", 1), {"2 images", "3 as"});
  expect_failure(stack("images=3\nslices=-1\n", 3), {"slices", "-1"});
  expect_failure(stack("images=3\nslices=3\nspacing=wide\n", 3), {"spacing", "wide"});
  expect_failure(stack("images=3\nslices=3\norder=zzz\n", 3), {"order", "zzz"});
  expect_failure(stack("slices=3\nsupple_index_to_lps_mm=1 2 3\n", 3), {"twelve numbers"});
  TiffOptions compressed;
  compressed.compression = 8;
  compressed.description = "ImageJ=1.53t\nimages=3\nslices=3\n";
  write_tiff(folder / "c.tif", 4, 3, compressed, std::string(12, 'a'));
  expect_failure(folder / "c.tif", {"compressed or scattered"});
}

}  // namespace
}  // namespace supple::test
