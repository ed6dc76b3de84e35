// Teem writes NRRD in every encoding and in several files, and must read such headers as we do;
// plastimatch (ITK's MetaIO) reads our compressed MetaImage.
#include <cstdlib>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "volumes/io/format/dense_writer.h"
#include "volumes/io/format/volume_file.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr int kCount = 5 * 4 * 3;

/// 60 shorts that use both bytes and both signs.
std::string values() {
  std::string bytes;
  for (int n = 0; n < kCount; ++n) {
    const int value = 977 * n - 30000;
    bytes.push_back(char(value & 255));
    bytes.push_back(char((value >> 8) & 255));
  }
  return bytes;
}

std::string write_source(const TemporaryFolder& folder) {
  write_text(folder / "source.nrrd",
             "NRRD0004\ntype: short\ndimension: 3\nsizes: 5 4 3\nspacings: 1 2 3\n"
             "endian: little\nencoding: raw\n\n" +
                 values());
  return folder / "source.nrrd";
}

std::string read_all_of(const std::string& path) {
  const auto file = open_volume(path);
  const Vec3i& dims = file->header().geometry.dims();
  const std::size_t slice = std::size_t(dims.x) * dims.y * bytes_of(file->header().type);
  std::string bytes(slice * dims.z, '\0');
  for (int k = 0; k < dims.z; ++k) file->read_slice(bytes.data() + slice * k);
  return bytes;
}

}  // namespace

TEST(InteropTextFormats, EveryEncodingOfTeemReadsExactly) {
  if (!runs("command -v teem-unu")) GTEST_SKIP() << "teem-apps is not installed";
  const TemporaryFolder folder;
  const std::string source = write_source(folder);
  for (const std::string encoding : {"raw", "gzip", "bzip2", "ascii", "hex"}) {
    for (const std::string extension : {".nrrd", ".nhdr"}) {
      for (const std::string endian : {"little", "big"}) {
        // Teem prints swapped values as text.
        if (encoding == "ascii" && endian == "big") continue;
        const std::string path = folder / (encoding + endian + extension);
        ASSERT_TRUE(runs("teem-unu save -f nrrd -e " + encoding + " -en " + endian + " -i " +
                         source + " -o " + path))
            << path;
        EXPECT_EQ(read_all_of(path), values()) << path;
        EXPECT_EQ(open_volume(path)->header().geometry.spacing_mm(), Vec3d(1, 2, 3)) << path;
      }
    }
  }
}

TEST(InteropTextFormats, ListsAndNumbersOfTeemsSlicesAreReadAsTeemReadsThem) {
  if (!runs("command -v teem-unu")) GTEST_SKIP() << "teem-apps is not installed";
  const TemporaryFolder folder;
  const std::string source = write_source(folder);
  ASSERT_TRUE(runs("teem-unu dice -a 2 -i " + source + " -ff s%02d.nrrd -o " + (folder / "")));
  const std::string head =
      "NRRD0004\ntype: short\ndimension: 3\nsizes: 5 4 3\nendian: little\nencoding: raw\n"
      "byte skip: -1\ndata file: ";
  write_text(folder / "list.nhdr", head + "LIST\ns02.nrrd\ns00.nrrd\ns01.nrrd\n");
  write_text(folder / "numbers.nhdr", head + "s%02d.nrrd 0 2 1\n");
  write_text(folder / "downward.nhdr", head + "s%02d.nrrd 2 0 -1 2\n");
  write_text(folder / "whole.nhdr", head + "LIST 3\nsource.nrrd\n");
  for (const char* name : {"list.nhdr", "numbers.nhdr", "downward.nhdr", "whole.nhdr"}) {
    const std::string theirs = folder / (std::string(name) + ".nrrd");
    ASSERT_TRUE(runs("teem-unu save -f nrrd -e raw -i " + (folder / name) + " -o " + theirs));
    EXPECT_EQ(read_all_of(folder / name), read_all_of(theirs)) << name;
  }
  EXPECT_EQ(read_all_of(folder / "numbers.nhdr"), values());
}

TEST(InteropTextFormats, OurGzippedNrrdAndCompressedMetaImageReadElsewhere) {
  const TemporaryFolder folder;
  const Geometry grid({5, 4, 3}, {1, 2, 3}, {Vec3d(1, 0, 0), {0, 2, 0}, {0, 0, 3}});
  DenseImage image;
  image.geometry = grid;
  image.type = ValueType::int16;
  WriteOptions options;
  options.compress = true;
  const auto write = [&](const std::string& path) {
    const auto writer = create_dense(path, image, options);
    for (std::size_t k = 0; k < 3; ++k) writer->write_slice(values().data() + k * 40);
    writer->commit();
  };
  write(folder / "a.mha");
  write(folder / "a.nrrd");
  if (!runs("command -v teem-unu") || !runs("plastimatch --version")) {
    GTEST_SKIP() << "teem-apps or plastimatch is not installed";
  }
  ASSERT_TRUE(runs("teem-unu save -f nrrd -e raw -i " + (folder / "a.nrrd") + " -o " +
                   (folder / "teem.nrrd")));
  EXPECT_EQ(read_all_of(folder / "teem.nrrd"), values());
  ASSERT_TRUE(runs("plastimatch convert --input " + (folder / "a.mha") + " --output-img " +
                   (folder / "itk.nrrd")));
  EXPECT_EQ(read_all_of(folder / "itk.nrrd"), values());
  EXPECT_EQ(open_volume(folder / "itk.nrrd")->header().geometry, grid);
}
