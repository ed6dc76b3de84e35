// Slices that were left out without a word: without preamble, gzipped, scouts within the series;
// and values that a slope of 0 makes equal.
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/support/dicom_fixtures.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {
namespace {

std::string bytes_of_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// Writes the data set of slice k alone, without preamble and meta information.
void write_bare(const TemporaryFolder& folder, const SeriesFixture& series, int k,
                E_TransferSyntax syntax) {
  DcmFileFormat file;
  series.fill(*file.getDataset(), k);
  const std::string path = folder / series.file_name(k);
  ASSERT_TRUE(file.getDataset()->saveFile(path.c_str(), syntax).good());
}

TEST(UnitDicomLeftOut, SlicesWithoutPreambleAreRead) {
  for (const E_TransferSyntax syntax :
       {EXS_LittleEndianImplicit, EXS_LittleEndianExplicit, EXS_BigEndianExplicit}) {
    for (const std::vector<int>& bare : {std::vector<int>{0, 1, 2, 3, 4, 5}, {5}, {2}}) {
      const TemporaryFolder folder;
      const SeriesFixture series;
      series.write_all(folder);
      for (const int k : bare) write_bare(folder, series, k, syntax);
      const auto file = open_volume(folder / ".");
      expect_geometry(file->header().geometry, series.geometry());
      EXPECT_EQ(values_of(*file), expected_values(series)) << DcmXfer(syntax).getXferName();
      EXPECT_TRUE(file->header().warnings.empty());
      EXPECT_EQ(values_of(*open_volume(folder / series.file_name(bare[0]))),
                expected_values(series));
    }
  }
}

TEST(UnitDicomLeftOut, MetaInformationWithoutPreambleIsRead) {
  const TemporaryFolder folder;
  const SeriesFixture series;
  series.write_all(folder);
  const std::string path = folder / series.file_name(3), whole = bytes_of_file(path);
  write_bytes(path, whole.substr(132));  // meta information first
  EXPECT_EQ(values_of(*open_volume(folder / ".")), expected_values(series));
  write_bytes(path, whole.substr(128));  // "DICM" first
  EXPECT_EQ(values_of(*open_volume(folder / ".")), expected_values(series));
}

TEST(UnitDicomLeftOut, WhatLooksAlmostLikeADataSetIsNone) {
  const TemporaryFolder folder;
  const SeriesFixture series;
  series.write_all(folder);
  write_bytes(folder / "values.raw",
              std::string("\x08\0\x05\0\x09\0\x04\0", 8) + std::string(400, 'x'));
  write_bytes(folder / "zeros.raw", std::string(400, '\0'));
  const auto file = open_volume(folder / ".");
  EXPECT_EQ(values_of(*file), expected_values(series));
  EXPECT_TRUE(file->header().warnings.empty());
}

TEST(UnitDicomLeftOut, GzippedSlicesAreNamed) {
  const TemporaryFolder folder;
  const SeriesFixture series;
  series.write_all(folder);
  const std::string path = folder / series.file_name(5), name = series.file_name(5) + ".gz";
  write_bytes(folder / name, gzip(bytes_of_file(path)));
  std::filesystem::remove(path);
  const auto file = open_volume(folder / ".");
  ASSERT_EQ(file->header().warnings.size(), 1u);
  EXPECT_NE(file->header().warnings[0].find(name + " is left out"), std::string::npos);
  EXPECT_NE(file->header().warnings[0].find("gzip"), std::string::npos);
  for (int k = 0; k < 5; ++k) std::filesystem::remove(folder / series.file_name(k));
  const std::string line = failure_of(folder / ".");
  EXPECT_NE(line.find("gunzip"), std::string::npos) << line;
}

TEST(UnitDicomLeftOut, AScoutOfTheSeriesIsLeftOutWithAWarning) {
  const TemporaryFolder folder;
  const SeriesFixture series;
  series.write_all(folder);
  SeriesFixture scout;
  scout.dims = {9, 7, 1};
  scout.column = {0, 0, -1};
  scout.edit = [](DcmDataset& data, int) {
    put(data, DCM_SOPInstanceUID, "1.2.3.4");
    put(data, DCM_ImageType, "ORIGINAL\\PRIMARY\\LOCALIZER");
  };
  scout.write(folder, 0, "a_scout");
  const auto file = open_volume(folder / series.file_name(2));
  EXPECT_EQ(values_of(*file), expected_values(series));
  ASSERT_EQ(file->header().warnings.size(), 1u);
  EXPECT_NE(file->header().warnings[0].find("a_scout"), std::string::npos);
  EXPECT_NE(file->header().warnings[0].find("LOCALIZER"), std::string::npos);
  EXPECT_EQ(open_volume(folder / "a_scout")->header().geometry.dims(), Vec3i(9, 7, 1));
}

TEST(UnitDicomLeftOut, TheOddImageOfASeriesIsTheOneThatIsNamed) {
  const TemporaryFolder folder;
  const SeriesFixture series;
  series.write_all(folder);
  SeriesFixture odd;
  odd.dims = {9, 7, 1};
  odd.edit = [](DcmDataset& data, int) { put(data, DCM_SOPInstanceUID, "1.2.3.4"); };
  odd.write(folder, 0, "a_odd");
  const std::string line = failure_of(folder / ".");
  EXPECT_NE(line.find("a_odd: Rows: found 7, expected 4"), std::string::npos) << line;
}

TEST(UnitDicomLeftOut, ASlopeOfZeroIsWarnedOf) {
  const TemporaryFolder folder;
  SeriesFixture series;
  series.edit = [](DcmDataset& data, int) {
    put(data, DCM_RescaleSlope, "0");
    put(data, DCM_RescaleIntercept, "-1024");
  };
  series.write_all(folder);
  const auto file = open_volume(folder / ".");
  ASSERT_EQ(file->header().warnings.size(), 1u);
  EXPECT_NE(file->header().warnings[0].find("slope 0"), std::string::npos);
}

}  // namespace
}  // namespace supple::test
