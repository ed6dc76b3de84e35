// Bad input: one line that names file, field, found and expected; never a crash, never a large
// allocation for a small file.
#include <filesystem>
#include <functional>
#include <random>

#include <gtest/gtest.h>
#include <png.h>

#include "tests/support/io_fixtures.h"
#include "tests/support/sanitized.h"
#include "volumes/base/error.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"
#include "volumes/io/warp_file.h"

namespace supple::test {
namespace {

const std::string kData(24, 'x');  // 2 x 3 x 2 int16

std::string nrrd_of(const std::string& fields) {
  return "NRRD0004\n" + fields + "\n";
}

const std::string kSound =
    "type: short\ndimension: 3\nsizes: 2 3 2\nencoding: raw\nendian: little\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("nothing to replace: " + from);
  return text.replace(at, from.size(), to);
}

TEST(FaultFile, MissingFolderDeviceAndEmptyFileAreNamed) {
  const TemporaryFolder folder;
  expect_failure(folder / "none.nrrd", {"none.nrrd", "no such file"});
  expect_failure(folder / ".", {"a directory"});
  expect_failure("/dev/zero", {"/dev/zero", "a device"});
  expect_failure(folder.write("empty.nii", ""), {"empty.nii", "found 0 bytes"});
  expect_failure(folder.write("noise.xyz", "whatever this is"), {"noise.xyz", "unknown content"});
  for (const std::string& content : {nrrd_of(kSound) + kData, std::string(128, 'x') + "DICM"}) {
    expect_failure(folder.write("packed.gz", gzip(content)), {"gzipped", "not NIfTI", "gunzip"});
  }
  expect_failure(folder.write("values.raw", kData), {"values.raw", "raw dims"});
  expect_failure(folder.write("fog.vdb", std::string(" BDV\0\0\0\0", 8) + kData),
                 {"fog.vdb", "OpenVDB"});
}

TEST(FaultFile, RawSizeThatContradictsTheHeaderPrintsBothNumbers) {
  const TemporaryFolder folder;
  const std::string spec = "dims=2,3,2,type=int16,spacing=1,1,1";
  expect_failure(folder.write("short.raw", kData.substr(1)), {"23 bytes", "24 bytes"}, {spec});
  expect_failure(folder.write("long.raw", kData + "y"), {"25 bytes", "24 bytes"}, {spec});
  expect_failure(folder.write("short.nrrd", nrrd_of(kSound) + kData.substr(2)), {"22", "24 bytes"});
  expect_failure(folder.write("long.nrrd", nrrd_of(kSound) + kData + "yy"),
                 {"26 bytes", "24 bytes"});
  folder.write("d.raw", kData.substr(5));
  expect_failure(folder.write("d.nhdr", nrrd_of(kSound + "data file: d.raw\n")),
                 {"d.raw", "19 bytes", "24 bytes"});
  expect_failure(folder.write("e.nhdr", nrrd_of(kSound + "data file: gone.raw\n")),
                 {"gone.raw", "no such file"});
  expect_failure(folder.write("a.nii", nifti_header({2, 3, 2}) + kData.substr(1)),
                 {"a.nii", "23 bytes", "24 bytes"});
}

TEST(FaultFile, HugeDimsWithATinyFileAreRejectedBeforeAllocation) {
  const TemporaryFolder folder;
  const std::string big = replaced(kSound, "2 3 2", "8000 8000 8000");
  expect_failure(folder.write("a.nrrd", nrrd_of(big) + kData), {"24 bytes", "1024000000000 bytes"});
  expect_failure(folder.write("b.nrrd", nrrd_of(replaced(big, "raw", "gzip")) + gzip(kData)),
                 {"compressed", "1024000000000 bytes"});
  expect_failure(
      folder.write("c.nrrd", nrrd_of(replaced(kSound, "2 3 2", "2000000000 2000000000 9"))),
      {"2^40"});
  expect_failure(
      folder.write("d.nrrd", nrrd_of(replaced(kSound, "2 3 2", "2 3 99999999999999999999"))),
      {"sizes", "99999999999999999999"});
  expect_failure(folder.write("e.nii", nifti_header({30000, 30000, 1000}) + kData),
                 {"24 bytes", "1800000000000 bytes"});
  expect_failure(folder.write("f.raw", kData), {"24 bytes", "2000000 bytes"},
                 {"dims=100,100,100,type=int16,spacing=1,1,1"});
}

TEST(FaultFile, CompressedDataThatEndsEarlyOrIsDamagedIsAnError) {
  const TemporaryFolder folder;
  const std::string head = nrrd_of(replaced(kSound, "raw", "gzip")), packed = gzip(kData);
  expect_failure(folder.write("a.nrrd", head + packed.substr(0, packed.size() / 2)),
                 {"compressed data", "end of the file"});
  expect_failure(folder.write("b.nrrd", head + gzip(kData.substr(3))), {"21", "24 bytes"});
  expect_failure(folder.write("c.nrrd", head + gzip(kData + "y")), {"more than 24 bytes"});
  std::string wrong_sum = packed;
  wrong_sum[wrong_sum.size() - 8] = char(wrong_sum[wrong_sum.size() - 8] ^ 1);
  expect_failure(folder.write("d.nrrd", head + wrong_sum), {"compressed data"});
  expect_failure(folder.write("e.nrrd", head + packed.substr(0, packed.size() - 8)),
                 {"compressed data"});
  expect_failure(folder.write("f.nrrd", head + kData), {"compressed data"});
}

TEST(FaultHeader, NrrdFieldsAreCheckedOneByOne) {
  const TemporaryFolder folder;
  int n = 0;
  const auto expect = [&](const std::string& from, const std::string& to,
                          const std::vector<std::string>& parts) {
    const std::string name = "n" + std::to_string(n++) + ".nrrd";
    std::vector<std::string> all = parts;
    all.push_back(name);
    expect_failure(folder.write(name, nrrd_of(replaced(kSound, from, to)) + kData), all);
  };
  expect("short", "shirt", {"type", "shirt", "scalar type"});
  expect("2 3 2", "2 -3 2", {"sizes", "2 -3 2"});
  expect("2 3 2", "2 0 2", {"sizes", "2 0 2"});
  expect("2 3 2", "2 3", {"sizes", "3 sizes"});
  expect("2 3 2", "2 3 two", {"sizes", "integers"});
  expect("dimension: 3", "dimension: 99", {"dimension", "99"});
  expect("encoding: raw", "encoding: lzma", {"encoding", "lzma", "raw, gzip, bzip2, ascii or hex"});
  expect("endian: little", "endian: middle", {"endian", "middle"});
  expect("endian: little\n", "", {"endian", "nothing"});
  expect("encoding", "encodign", {"encodign"});
  expect("encoding: raw", "encoding raw", {"header line"});
  expect("encoding: raw", "encoding: raw\nspacings: 1 nan 1", {"spacings", "nan"});
  expect("encoding: raw", "encoding: raw\nspacings: 1 -1 1", {"spacings", "-1"});
  expect("encoding: raw", "encoding: raw\nspace: LPS\nspace directions: (1,0,0) (0,nan,0) (0,0,1)",
         {"direction", "nan"});
  expect("encoding: raw", "encoding: raw\nspace: LPS\nspace directions: (1,0,0) (2,0,0) (0,0,1)",
         {"direction", "independent"});
  expect("encoding: raw", "encoding: raw\nspace: LPX\nspace directions: (1,0,0) (0,1,0) (0,0,1)",
         {"space", "LPX"});
  expect("encoding: raw", "encoding: raw\nspace: LPS\nspace directions: (1,0,0 (0,1,0) (0,0,1)",
         {"space directions"});
  expect("encoding: raw", "encoding: raw\nbyte skip: 1000", {"byte skip", "1000"});
  expect("encoding: raw", "encoding: raw\ntype: short", {"type", "twice"});
  expect_failure(folder.write("m.nrrd", "NRRD9999\n" + kSound), {"magic", "NRRD9999"});
  expect_failure(folder.write("h.nrrd", "NRRD0004\n" + kSound), {"blank line"});
}

TEST(FaultHeader, MetaImageFieldsAreCheckedOneByOne) {
  const TemporaryFolder folder;
  const std::string sound =
      "ObjectType = Image\nNDims = 3\nDimSize = 2 3 2\nElementType = MET_SHORT\n"
      "ElementSpacing = 1 1 1\nElementDataFile = LOCAL\n";
  int n = 0;
  const auto expect = [&](const std::string& from, const std::string& to,
                          const std::vector<std::string>& parts) {
    const std::string name = "m" + std::to_string(n++) + ".mha";
    expect_failure(folder.write(name, replaced(sound, from, to) + kData), parts);
  };
  expect("NDims = 3", "NDims = 5", {"NDims", "5"});
  expect("NDims = 3", "NDims = 4", {"DimSize", "as many sizes"});
  expect("2 3 2", "2 -3 2", {"DimSize", "2 -3 2"});
  expect("2 3 2", "2 3", {"DimSize"});
  expect("MET_SHORT", "MET_STRING", {"ElementType", "MET_STRING"});
  expect("1 1 1", "1 1 NaN", {"ElementSpacing", "NaN"});
  expect("1 1 1", "1 0 1", {"ElementSpacing"});
  expect("ElementSpacing", "TransformMatrix = 1 0 0 0 1 0 1 0 0\nElementSpacing", {"direction"});
  expect("ElementSpacing", "CompressedData = maybe\nElementSpacing", {"CompressedData", "maybe"});
  expect("ElementSpacing", "ElementNumberOfChannels = 17\nElementSpacing", {"Channels", "17"});
  expect("ElementSpacing", "HeaderSize = -7\nElementSpacing", {"HeaderSize", "-7"});
  expect("LOCAL", "LIST 7", {"ElementDataFile", "LIST 7", "1 to 3 dimensions"});
  expect("ElementDataFile = LOCAL", "", {"header line"});
}

TEST(FaultHeader, NiftiFieldsAreCheckedOneByOne) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::function<void(std::string&)>& spoil,
                          const std::vector<std::string>& parts) {
    std::string header = nifti_header({2, 3, 2});
    spoil(header);
    expect_failure(folder.write("a.nii", header + kData), parts);
  };
  expect([](std::string& h) { patch(h, 42, std::int16_t(-2)); }, {"dim[1]", "-2"});
  expect([](std::string& h) { patch(h, 40, std::int16_t(9)); }, {"dim[0]", "9"});
  expect([](std::string& h) { patch(h, 70, std::int16_t(32)); }, {"datatype", "32"});
  expect([](std::string& h) { patch(h, 72, std::int16_t(8)); }, {"bitpix", "8", "16"});
  expect([](std::string& h) { patch(h, 80, std::nanf("")); }, {"pixdim[1]", "nan"});
  expect([](std::string& h) { patch(h, 80, 0.0f); }, {"pixdim[1]", "0"});
  expect([](std::string& h) { patch(h, 254, std::int16_t(1)); }, {"spacing and direction"});
  expect([](std::string& h) { patch(h, 108, 1e30f); }, {"vox_offset"});
  expect([](std::string& h) { patch(h, 108, 100.0f); }, {"vox_offset", "100", "352"});
  expect([](std::string& h) { patch(h, 344, 'x'); }, {"magic"});
  expect_failure(folder.write("b.nii", nifti_header({2, 3, 1, 2}) + kData),
                 {"dim[4]", "2 frames", "frame 0 to 1"});
}

TEST(FaultHeader, RawSpecsAreCheckedOneByOne) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a.raw", kData);
  expect_failure(path, {"raw", "dimz"}, {"dimz=2,3,2,type=int16,spacing=1,1,1"});
  expect_failure(path, {"raw dims", "nothing"}, {"type=int16,spacing=1,1,1"});
  expect_failure(path, {"raw type", "short"}, {"dims=2,3,2,type=short,spacing=1,1,1"});
  expect_failure(path, {"raw spacing"}, {"dims=2,3,2,type=int16"});
  expect_failure(path, {"raw spacing", "nan"}, {"dims=2,3,2,type=int16,spacing=1,nan,1"});
  expect_failure(path, {"raw endian", "pdp"}, {"dims=2,3,2,type=int16,spacing=1,1,1,endian=pdp"});
  expect_failure(path, {"offset", "-4"}, {"dims=2,3,2,type=int16,spacing=1,1,1,offset=-4"});
  expect_failure(path, {"offset", "99"}, {"dims=2,3,2,type=int16,spacing=1,1,1,offset=99"});
  expect_failure(path, {"raw"}, {"2,3,2"});
  expect_failure(path, {"raw dims", "twice"}, {"dims=2,3,2,dims=1,1"});
}

TEST(FaultImage, ColourSamplesAndTruncationAreErrors) {
  const TemporaryFolder folder;
  write_png(folder / "rgb.png", 2, 1, 8, PNG_COLOR_TYPE_RGB, "abcdef");
  expect_failure(folder / "rgb.png", {"rgb.png", "colour", "grey"});
  write_png(folder / "pal.png", 2, 1, 8, PNG_COLOR_TYPE_PALETTE, std::string("\0\1", 2));
  expect_failure(folder / "pal.png", {"palette"});
  write_png(folder / "a.png", 40, 40, 8, PNG_COLOR_TYPE_GRAY, std::string(1600, 'q'));
  const auto size = std::filesystem::file_size(folder / "a.png");
  std::filesystem::resize_file(folder / "a.png", size - 20);
  expect_failure(folder / "a.png", {"a.png", "PNG"});

  TiffOptions rgb;
  rgb.samples = 3;
  rgb.photometric = 2;
  write_tiff(folder / "rgb.tif", 2, 2, rgb, std::string(12, 'r'));
  expect_failure(folder / "rgb.tif", {"3 components", "channel 0 to 2"});
  write_tiff(folder / "t.tif", 50, 50, TiffOptions(), std::string(2500, 't'));
  std::filesystem::resize_file(folder / "t.tif", 1000);
  expect_failure(folder / "t.tif", {"t.tif", "TIFF"});
}

/// One to four random edits near the front of the file, where headers lie.
std::string mutated(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return std::size_t(random() % n); };
  static const char* const snippets[] = {"-1", "0", "99999999999", "nan", "1e300", "\n",        " ",
                                         "(",  ")", ":",           "=",   "none",  "4294967296"};
  for (std::size_t edit = 1 + below(4); edit > 0 && !bytes.empty(); --edit) {
    const std::size_t at = below(std::min<std::size_t>(bytes.size(), 600));
    switch (below(6)) {
      case 0:
        bytes[at] = char(random());
        break;
      case 1:
        bytes[at] = char(bytes[at] ^ (1 << below(8)));
        break;
      case 2:
        bytes.insert(at, snippets[below(std::size(snippets))]);
        break;
      case 3:
        bytes.erase(at, 1 + below(4));
        break;
      case 4:
        bytes[at] = char('0' + below(10));
        break;
      default:
        if (below(4) == 0) bytes.resize(at);
    }
  }
  return bytes;
}

TEST(FaultFuzz, MutatedFilesReadOrThrowInputError) {
  const TemporaryFolder folder;
  const std::string data(2 * 9 * 10 * 11, 'd');
  const std::string fields =
      "type: short\ndimension: 3\nsizes: 9 10 11\nspace: LPS\n"
      "space directions: (1,0,0) (0,1,0) (0,0,1)\nendian: little\n";
  write_png(folder / "s.png", 30, 20, 16, PNG_COLOR_TYPE_GRAY, std::string(1200, 'p'));
  TiffOptions tiles;
  tiles.tile = 16;
  tiles.compression = 8;
  write_tiff(folder / "tiles.tif", 40, 30, tiles, std::string(1200, 't'));
  TiffOptions strips;
  strips.bits = 16;
  write_tiff(folder / "strips.tif", 20, 12, strips, std::string(480, 's'));
  TiffOptions page;
  page.description = "ImageJ=1.53t\nimages=3\nslices=3\nunit=mm\nspacing=1.5\n";
  for (int k = 0; k < 3; ++k) {
    write_tiff(folder / "stack.tif", 9, 5, page, std::string(45, char('a' + k)));
    page.mode = "a";
  }
  std::string sform = nifti_header({9, 10, 11});
  patch(sform, 254, std::int16_t(1));
  patch(sform, 280, 1.0f);
  patch(sform, 300, 1.0f);
  patch(sform, 320, 1.0f);
  const std::vector<std::pair<std::string, std::string>> seeds = {
      {"a.nrrd", nrrd_of(fields + "encoding: raw\n") + data},
      {"b.nrrd", nrrd_of(fields + "encoding: gzip\n") + gzip(data)},
      {"c.mha",
       "ObjectType = Image\nNDims = 3\nDimSize = 9 10 11\nElementType = MET_SHORT\n"
       "TransformMatrix = 1 0 0 0 1 0 0 0 1\nHeaderSize = -1\nElementDataFile = LOCAL\n" +
           data},
      {"d.mha",
       "NDims = 3\nDimSize = 9 10 11\nElementType = MET_SHORT\nCompressedData = True\n"
       "ElementDataFile = LOCAL\n" +
           zlib_stream(data)},
      {"e.nii", sform + data},
      {"f.nii.gz", gzip(sform + data)},
      {"g.png", read_text(folder / "s.png")},
      {"h.tif", read_text(folder / "tiles.tif")},
      {"i.tif", read_text(folder / "strips.tif")},
      {"j.tif", read_text(folder / "stack.tif")}};

  std::mt19937 random(20010101);
  int read = 0, refused = 0;
  for (const auto& [name, sound] : seeds) {
    ASSERT_EQ(failure_of(folder.write(name, sound)), "") << name;
    for (int round = 0; round < cases(500); ++round) {
      const std::string path = folder.write(name, mutated(sound, random));
      try {
        digest_volume(*open_volume(path));
        ++read;
      } catch (const InputError& error) {
        ++refused;
        const std::string line = error.what();
        ASSERT_EQ(line.find('\n'), std::string::npos) << line;
        ASSERT_NE(line.find((folder / "").substr(0, 5)), std::string::npos) << line;
      }
    }
  }
  EXPECT_GT(read, cases(100));
  EXPECT_GT(refused, cases(1000));
}

TEST(FaultFuzz, MutatedFilesOfVectorsReadOrThrowInputError) {
  const TemporaryFolder folder;
  const std::string data = bytes_of_values(std::vector<float>(3 * 5 * 6 * 7, 0.5f));
  const std::string axes =
      "space: LPS\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\nspace units: \"mm\" \"mm\"\n"
      "measurement frame: (1,0,0) (0,1,0) (0,0,1)\nsupple direction:=resample\n";
  const std::vector<std::pair<std::string, std::string>> seeds = {
      {"a.nrrd",
       "NRRD0005\ntype: float\ndimension: 4\nsizes: 3 5 6 7\nendian: little\n"
       "kinds: vector domain domain domain\nencoding: raw\n" +
           axes + "\n" + data},
      {"b.mha",
       "Comment = supple direction resample, vectors in mm LPS\nNDims = 3\nDimSize = 5 6 7\n"
       "ElementNumberOfChannels = 3\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n" +
           data}};
  std::mt19937 random(42);
  int read = 0, refused = 0;
  for (const auto& [name, sound] : seeds) {
    ASSERT_NO_THROW(read_warp(folder.write(name, sound)));
    for (int round = 0; round < cases(400); ++round) {
      const std::string path = folder.write(name, mutated(sound, random));
      try {
        read_warp(path);
        ++read;
      } catch (const InputError& error) {
        ++refused;
        ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      }
    }
  }
  EXPECT_GE(read, cases(20));
  EXPECT_GT(refused, cases(100));
}

TEST(FaultFuzz, MutatedRawSpecsReadOrThrowInputError) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a.raw", kData);
  std::mt19937 random(4);
  for (int round = 0; round < 2000; ++round) {
    const std::string spec =
        mutated("dims=2,3,2,type=int16,spacing=1,1,1,endian=big,offset=0", random);
    if (spec.empty()) continue;
    EXPECT_NO_THROW(failure_of(path, {spec})) << spec;
  }
}

}  // namespace
}  // namespace supple::test
