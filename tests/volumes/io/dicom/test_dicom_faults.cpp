// DICOM files that cannot be a volume: one line that says why; no crash, no block, no large
// allocation for a small file.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/dicom_fixtures.h"
#include "tests/support/dicom_jpeg2000.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {
namespace {

void expect_failure(const std::string& path, const std::vector<std::string>& parts) {
  const std::string line = failure_of(path);
  EXPECT_NE(line, "") << path << " was read";
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  EXPECT_LT(line.size(), 600u) << line;
  for (const std::string& part : parts) {
    EXPECT_NE(line.find(part), std::string::npos) << "\"" << part << "\" in: " << line;
  }
}

using Edit = std::function<void(DcmDataset&, int)>;

/// The line of a series whose slices were edited.
void expect_edited_failure(const Edit& edit, const std::vector<std::string>& parts) {
  const TemporaryFolder folder;
  SeriesFixture series;
  series.edit = edit;
  series.write_all(folder);
  expect_failure(folder / ".", parts);
}

Edit putting(const DcmTagKey& tag, const std::string& value, int only_slice = -1) {
  return [=](DcmDataset& data, int k) {
    if (only_slice < 0 || k == only_slice) put(data, tag, value);
  };
}

Edit putting_number(const DcmTagKey& tag, int value, int only_slice = -1) {
  return [=](DcmDataset& data, int k) {
    if (only_slice < 0 || k == only_slice) data.putAndInsertUint16(tag, Uint16(value));
  };
}

Edit deleting(const DcmTagKey& tag) {
  return [=](DcmDataset& data, int) { data.findAndDeleteElement(tag); };
}

TEST(FaultDicom, MissingAttributesAreNamed) {
  for (const DcmTagKey& tag :
       {DCM_PixelSpacing, DCM_ImagePositionPatient, DCM_ImageOrientationPatient, DCM_BitsAllocated,
        DCM_PhotometricInterpretation, DCM_PixelData}) {
    expect_edited_failure(deleting(tag), {DcmTag(tag).getTagName(), "found nothing"});
  }
}

TEST(FaultDicom, AttributesThatMakeNoVolumeAreRefused) {
  expect_edited_failure(putting(DCM_PixelSpacing, "0\\0.5"), {"PixelSpacing", "positive"});
  expect_edited_failure(putting(DCM_PixelSpacing, "0.5"), {"PixelSpacing", "2 numbers"});
  expect_edited_failure(putting(DCM_ImagePositionPatient, "1\\x\\2"),
                        {"ImagePositionPatient", "x"});
  expect_edited_failure(putting(DCM_ImageOrientationPatient, "1\\0\\0\\1\\0\\0"),
                        {"ImageOrientationPatient", "perpendicular"});
  expect_edited_failure(putting(DCM_PhotometricInterpretation, "RGB"), {"RGB", "grey"});
  expect_edited_failure(putting_number(DCM_SamplesPerPixel, 3), {"SamplesPerPixel", "3"});
  expect_edited_failure(putting_number(DCM_BitsAllocated, 12), {"BitsAllocated", "12"});
  expect_edited_failure(putting_number(DCM_BitsStored, 17), {"BitsStored", "17", "1 to 16"});
  expect_edited_failure(putting_number(DCM_HighBit, 16), {"HighBit", "16", "15 to 15"});
  expect_edited_failure(putting_number(DCM_Rows, 0), {"Rows", "found 0"});
  expect_edited_failure(putting(DCM_RescaleSlope, "steep"), {"RescaleSlope", "steep"});
}

TEST(FaultDicom, SlicesOfDifferentKindsNameTwoFilesAndBothValues) {
  expect_edited_failure(putting_number(DCM_Rows, 3, 4), {"im31", "Rows", "found 3", "4 as in im"});
  expect_edited_failure(putting_number(DCM_Columns, 4, 4),
                        {"im31", "Columns", "found 4", "5 as in"});
  expect_edited_failure(putting(DCM_PixelSpacing, "0.75\\0.6", 4),
                        {"im31", "PixelSpacing", "0.75\\0.6", "0.75\\0.5 as in"});
  expect_edited_failure(putting(DCM_ImageOrientationPatient, "0\\1\\0\\1\\0\\0", 4),
                        {"im31", "ImageOrientationPatient", "0\\1\\0\\1\\0\\0"});
  expect_edited_failure(putting_number(DCM_PixelRepresentation, 0, 4), {"PixelRepresentation"});
  expect_edited_failure(putting(DCM_PhotometricInterpretation, "MONOCHROME1", 4),
                        {"found MONOCHROME1", "MONOCHROME2 as in"});
}

TEST(FaultDicom, SeveralSeriesAreListed) {
  const TemporaryFolder folder;
  SeriesFixture series, other;
  other.series = "1.2.826.0.1.3680043.8.498.2";
  series.write_all(folder);
  other.write(folder, 0, "other");
  expect_failure(folder / ".",
                 {"2 series", "6 files \"Synthetic 1\" (UID ...0043.8.498.1, such as im10)",
                  "1 files \"Synthetic 2\"", "such as other", "name a file of it"});
}

TEST(FaultDicom, UnevenDistancesAreRefused) {
  const auto at = [](std::vector<double> heights) {
    return [heights](DcmDataset& data, int k) {
      put(data, DCM_ImagePositionPatient, ds({0, 0, heights[std::size_t(k)]}));
    };
  };
  expect_edited_failure(at({0, 2, 4, 6.5, 8, 10}), {"0.5 mm off its even place", "2 mm"});
  expect_edited_failure(at({0, 2, 4, 6, 12, 18}), {"2 mm to 6 mm", "uneven"});
  expect_edited_failure(at({0, 2, 2.5, 4, 6, 8}), {"0.5 mm to 2 mm"});
  expect_edited_failure(at({0, 2, 4, 6, 6, 8}), {"1 at 0 mm", "2 at 6 mm", "same number"});
}

TEST(FaultDicom, TruncatedFilesAreRefusedBeforeAnySliceIsRead) {
  const TemporaryFolder folder;
  const SeriesFixture series;
  const std::string path = series.write(folder, 0);
  const std::uintmax_t size = std::filesystem::file_size(path);
  std::filesystem::resize_file(path, size - 6);
  expect_failure(path, {"PixelData", "34 bytes before the end", "40 bytes"});
  for (std::uintmax_t cut = size - 60; cut > 132; cut -= 37) {
    std::filesystem::resize_file(path, cut);
    expect_failure(path, {path});
  }
}

TEST(FaultDicom, TruncatedCompressedPixelsAreRefused) {
  for (const E_TransferSyntax syntax : {EXS_RLELossless, EXS_JPEGProcess14SV1, EXS_JPEGLSLossless,
                                        EXS_DeflatedLittleEndianExplicit, EXS_JPEG2000}) {
    const TemporaryFolder folder;
    SeriesFixture series;
    series.syntax = syntax;
    const std::string path = series.write(folder, 0);
    std::filesystem::resize_file(path, std::filesystem::file_size(path) - 30);
    expect_failure(path, {path});
  }
}

TEST(FaultDicom, HugeSizesInATinyFileAreRefusedBeforeAllocation) {
  expect_edited_failure(
      [](DcmDataset& data, int) {
        data.putAndInsertUint16(DCM_Rows, 65535);
        data.putAndInsertUint16(DCM_Columns, 65535);
      },
      {"bytes", "enough for 8.58967e+09 bytes"});
  expect_edited_failure(putting(DCM_NumberOfFrames, "2000000000"), {"enough for 8e+10 bytes"});
}

TEST(FaultDicom, FoldersWithoutImagesArePlainFolders) {
  const TemporaryFolder folder;
  expect_failure(folder / ".", {"a directory"});
  folder.write("text", std::string(500, 'x'));
  expect_failure(folder / ".", {"a directory"});
  expect_failure(folder.write("a.dcm", std::string(500, 'x')), {"unknown content"});
  expect_failure(folder.write("b.dcm", std::string(128, 'x') + "DICM" + std::string(100, '\xff')),
                 {"b.dcm", "Rows and Columns", "found nothing"});
}

TEST(FaultDicom, ADamagedFileBesideASeriesIsLeftOutWithAWarning) {
  const TemporaryFolder folder;
  const SeriesFixture series;
  series.write_all(folder);
  const int slices = open_volume(folder / ".")->header().geometry.dims().z;
  const std::string stranger = std::string(128, 'x') + "DICM" + std::string(200, '\x02');
  const std::string path = folder.write("stranger.dcm", stranger);
  expect_failure(path, {"stranger.dcm", "DICOM"});
  for (const std::string& name : {folder / ".", series.write(folder, 0)}) {
    const auto file = open_volume(name);
    EXPECT_EQ(file->header().geometry.dims().z, slices);
    ASSERT_EQ(file->header().warnings.size(), 1u);
    EXPECT_EQ(file->header().warnings.front().find("stranger.dcm is left out: DICOM"), 0u)
        << file->header().warnings.front();
  }
}

TEST(FaultDicom, AFolderOfDamagedFilesNamesOne) {
  const TemporaryFolder folder;
  folder.write("a.dcm", std::string(128, 'x') + "DICM" + std::string(200, '\x02'));
  expect_failure(folder / ".", {"a.dcm", "DICOM"});
}

TEST(FaultDicom, APipeInTheFolderIsNotOpened) {
  const TemporaryFolder folder;
  const SeriesFixture series;
  series.write_all(folder);
  ASSERT_EQ(::mkfifo((folder / "aa_pipe").c_str(), 0600), 0);
  EXPECT_EQ(values_of(*open_volume(folder / ".")), expected_values(series));
}

TEST(FaultDicom, SyntaxesThatAreNotReadAreNamed) {
  const TemporaryFolder folder;
  const SeriesFixture series;
  const std::string path = series.write(folder, 0);
  std::ifstream stream(path, std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(stream), {});
  const std::string plain = std::string("UI\x14\0", 4) + "1.2.840.10008.1.2.1" + '\0';
  const std::string video = std::string("UI\x18\0", 4) + "1.2.840.10008.1.2.4.100" + '\0';
  const std::size_t at = bytes.find(plain);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at, plain.size(), video);
  bytes[140] = char(bytes[140] + 4);  // the meta information's length
  expect_failure(folder.write("a", bytes),
                 {"1.2.840.10008.1.2.4.100 MPEG2", "JPEG-LS or JPEG 2000"});
}

TEST(FaultDicom, RleSegmentsOutsideTheirFrameAreRefused) {
  const TemporaryFolder folder;
  SeriesFixture series;
  series.syntax = EXS_RLELossless;
  const std::string path = series.write(folder, 0);
  std::string sound = read_text(path);
  // Two segments, the first of which follows the header of 64 bytes.
  const std::size_t header = sound.find(std::string("\2\0\0\0\x40\0\0\0", 8));
  ASSERT_NE(header, std::string::npos);
  const auto expect = [&](std::size_t at, std::uint32_t number) {
    std::string bytes = sound;
    patch(bytes, header + at, number);
    expect_failure(folder.write("b.dcm", bytes), {"frame 0", "an RLE header whose segments"});
    std::filesystem::remove(folder / "b.dcm");
  };
  std::filesystem::remove(path);
  expect(0, 0);
  expect(0, 16);
  expect(4, 63);           // inside the header
  expect(8, 64);           // where the first one begins
  expect(8, 0xFFFFFFB1u);  // 4 GiB away
  expect(8, 100000);
}

TEST(FaultDicom, CompressedStreamsThatContradictTheAttributesAreRefused) {
  for (const E_TransferSyntax syntax : {EXS_JPEGProcess14SV1, EXS_JPEGLSLossless}) {
    const bool jpeg = syntax == EXS_JPEGProcess14SV1;
    const TemporaryFolder folder;
    SeriesFixture series;
    series.bits_allocated = series.bits_stored = 8;
    series.is_signed = false;
    series.syntax = syntax;
    const std::string path = series.write(folder, 0);
    DcmFileFormat file;
    ASSERT_TRUE(file.loadFile(path.c_str()).good());
    file.getDataset()->putAndInsertUint16(DCM_BitsAllocated, 16);
    ASSERT_TRUE(file.saveFile((folder / "wide").c_str(), syntax).good());
    std::filesystem::remove(path);
    expect_failure(folder / "wide", {jpeg ? "found 5 x 4 values of 8 bits, expected 5 x 4 values "
                                            "of 16 bits"
                                          : "mismatch"});
    file.getDataset()->putAndInsertUint16(DCM_BitsAllocated, 8);
    file.getDataset()->putAndInsertUint16(DCM_Rows, 5);
    ASSERT_TRUE(file.saveFile((folder / "wide").c_str(), syntax).good());
    expect_failure(folder / "wide", {jpeg ? "found 5 x 4 values" : "mismatch"});
  }
}

TEST(FaultDicom, Jpeg2000StreamsThatContradictTheAttributesOrAreDamagedAreRefused) {
  const TemporaryFolder folder;
  SeriesFixture series;
  const auto expect = [&](const Edit& edit, const std::vector<std::string>& parts) {
    DcmFileFormat file;
    series.fill(*file.getDataset(), 0);
    compress_jpeg2000(*file.getDataset(), EXS_JPEG2000);
    edit(*file.getDataset(), 0);
    ASSERT_TRUE(file.saveFile((folder / "a").c_str(), EXS_JPEG2000).good());
    expect_failure(folder / "a", parts);
  };
  const std::string found = "JPEG 2000 stream: found 5 x 4 values of 1 component and 16 bits";
  expect(putting_number(DCM_Rows, 3), {found + ", expected 5 x 3 values"});
  expect(
      [](DcmDataset& data, int) {
        data.putAndInsertUint16(DCM_BitsAllocated, 8);
        data.putAndInsertUint16(DCM_BitsStored, 8);
        data.putAndInsertUint16(DCM_HighBit, 7);
      },
      {found});
  series.syntax = EXS_JPEG2000;
  const std::string sound = read_text(series.write(folder, 0, "a"));
  const std::size_t stream = sound.find("\xff\x4f\xff\x51");
  ASSERT_NE(stream, std::string::npos);
  std::string bytes = sound;
  bytes[stream + 1] = 0;
  expect_failure(folder.write("a", bytes), {"PixelData of frame 0"});
  // Damage anywhere in the stream is read as other values, or is one line.
  for (std::size_t at = stream; at + 2 < sound.size(); ++at) {
    for (const char changed : {char(sound[at] ^ 0x80), char(sound[at] + 1), '\xff'}) {
      bytes = sound;
      bytes[at] = changed;
      const std::string line = failure_of(folder.write("a", bytes));
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    }
  }
}

TEST(FaultDicom, SequencesNestedWithoutEndAreRefused) {
  const TemporaryFolder folder;
  const SeriesFixture series;
  const std::string path = series.write(folder, 0);
  std::ifstream stream(path, std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(stream), {});
  const std::size_t pixels = bytes.rfind(std::string("\xe0\x7f\x10\0", 4));
  std::string nested;
  for (int n = 0; n < 100000; ++n) {
    nested +=
        std::string("\x09\x00\x21\x12SQ\0\0\xff\xff\xff\xff\xfe\xff\0\xe0\xff\xff\xff\xff", 20);
  }
  bytes.insert(pixels, nested);
  expect_failure(folder.write("a", bytes), {"more than 64 in one another"});
}

}  // namespace
}  // namespace supple::test
