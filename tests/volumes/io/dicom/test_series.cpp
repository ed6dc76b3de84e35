// Places of the voxels of a DICOM series, whatever its files are called and however they are
// numbered.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/support/dicom_fixtures.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {
namespace {

SeriesFixture oblique() {
  SeriesFixture series;
  const double c = std::cos(0.4), s = std::sin(0.4);
  series.row = {c, s, 0};
  series.column = {0, 0, -1};
  series.step = series.row.cross(series.column) * 1.3;
  return series;
}

std::unique_ptr<VolumeFile> open_all(const TemporaryFolder& folder, const SeriesFixture& series,
                                     const ReadOptions& options = {}) {
  series.write_all(folder);
  return open_volume(folder / ".", options);
}

TEST(UnitDicomSeries, SlicesAreSortedByPositionWhateverTheirNamesAndNumbers) {
  const TemporaryFolder folder;
  const SeriesFixture series;
  const auto file = open_all(folder, series);
  EXPECT_EQ(file->header().format, "dicom");
  EXPECT_EQ(file->header().type, ValueType::int16);
  EXPECT_TRUE(file->header().warnings.empty());
  expect_geometry(file->header().geometry, series.geometry());
  EXPECT_EQ(values_of(*file), expected_values(series));
}

TEST(UnitDicomSeries, ObliqueSlicesKeepTheirDirectionsAndBothPixelSpacings) {
  const TemporaryFolder folder;
  const SeriesFixture series = oblique();
  const auto file = open_all(folder, series);
  expect_geometry(file->header().geometry, series.geometry());
  EXPECT_EQ(values_of(*file), expected_values(series));
}

TEST(UnitDicomSeries, SlicesThatDescendAlongTheNormalAreReadFromTheOtherEnd) {
  const TemporaryFolder folder;
  SeriesFixture series;
  series.step = {0, 0, -2};
  const auto file = open_all(folder, series);
  EXPECT_GT(file->header().geometry.determinant(), 0);
  SeriesFixture ascending = series;
  ascending.origin = series.origin + series.step * (series.dims.z - 1);
  ascending.step = {0, 0, 2};
  ascending.value = [](int i, int j, int k) { return SeriesFixture::default_value(i, j, 5 - k); };
  expect_geometry(file->header().geometry, ascending.geometry());
  EXPECT_EQ(values_of(*file), expected_values(ascending));
}

TEST(UnitDicomSeries, TheHeaderHasTheModality) {
  for (const char* const modality : {"CT", "MR", ""}) {
    const TemporaryFolder folder;
    SeriesFixture series;
    series.edit = [&](DcmDataset& data, int) { put(data, DCM_Modality, modality); };
    EXPECT_EQ(open_all(folder, series)->header().modality, modality);
  }
}

TEST(UnitDicomSeries, AFileStandsForItsSeriesInTheFolder) {
  const TemporaryFolder folder;
  SeriesFixture series, other;
  other.series += "2";
  other.dims.z = 3;
  for (int k = 0; k < 3; ++k) other.write(folder, k, "other" + std::to_string(k));
  series.write_all(folder);
  expect_geometry(open_volume(folder / (series.file_name(4)))->header().geometry,
                  series.geometry());
  expect_geometry(open_volume(folder / "other1")->header().geometry, other.geometry());
}

TEST(UnitDicomSeries, ATiltedGantryGivesShearedAxesAndAWarning) {
  const TemporaryFolder folder;
  SeriesFixture series;
  series.step = {0, 2 * std::tan(0.2), 2};
  const auto file = open_all(folder, series);
  expect_geometry(file->header().geometry, series.geometry());
  EXPECT_FALSE(file->header().geometry.is_orthogonal());
  ASSERT_EQ(file->header().warnings.size(), 1u);
  EXPECT_EQ(file->header().warnings[0], "gantry tilt of 11.4592 degrees: the axes are sheared");
}

TEST(UnitDicomSeries, RoundedPositionsAreEvenedOutAndKeepTheAxesPerpendicular) {
  const TemporaryFolder folder;
  SeriesFixture series;
  series.step = {0, 0, 0.625};
  series.edit = [](DcmDataset& data, int k) {
    const double rounded = std::round((-70 + 0.625 * k) * 10) / 10;
    put(data, DCM_ImagePositionPatient, ds({-12.5, k == 5 ? 30.001 : 30, rounded}));
  };
  const auto file = open_all(folder, series);
  SeriesFixture even = series;
  even.step = {0, 0, (-66.9 + 70) / 5};
  expect_geometry(file->header().geometry, even.geometry());
  ASSERT_EQ(file->header().warnings.size(), 1u);
  EXPECT_NE(file->header().warnings[0].find("off its even place"), std::string::npos);
}

TEST(UnitDicomSeries, AMissingSliceIsHeldByItsNeighbourAndTheOthersKeepTheirPlaces) {
  const TemporaryFolder folder;
  const SeriesFixture series;
  for (const int k : {0, 1, 2, 4, 5}) series.write(folder, k);
  const auto file = open_volume(folder / ".");
  expect_geometry(file->header().geometry, series.geometry());
  SeriesFixture held = series;
  held.value = [](int i, int j, int k) {
    return SeriesFixture::default_value(i, j, k == 3 ? 2 : k);
  };
  EXPECT_EQ(values_of(*file), expected_values(held));
  ASSERT_EQ(file->header().warnings.size(), 1u);
  EXPECT_EQ(file->header().warnings[0],
            "1 slice is missing (between -66 mm and -62 mm along the normal); the nearest slice "
            "stands in for each");
}

TEST(UnitDicomSeries, SlicesAtTheSamePositionsAreFramesInTheOrderOfTime) {
  const TemporaryFolder folder;
  SeriesFixture series;
  for (int f = 0; f < 2; ++f) {
    series.value = [f](int i, int j, int k) {
      return SeriesFixture::default_value(i, j, k) + 1000 * f;
    };
    series.edit = [f](DcmDataset& data, int k) {
      put(data, DCM_SOPInstanceUID, "1.2.3." + std::to_string(10 * f + k));
      put(data, DCM_TemporalPositionIdentifier, std::to_string(f + 1));
      put(data, DCM_InstanceNumber, std::to_string(20 - 10 * f + k));
    };
    for (int k = 0; k < series.dims.z; ++k) {
      series.write(folder, k, (f == 0 ? "z" : "a") + std::to_string(k));
    }
  }
  EXPECT_EQ(values_of(*open_volume(folder / ".", ReadOptions{"", 1, {}, {}})),
            expected_values(series));
  const std::string line = failure_of(folder / ".");
  EXPECT_NE(line.find("found 2 frames, expected frame 0 to 1"), std::string::npos) << line;
}

TEST(UnitDicomSeries, ACopyOfASliceIsLeftOutWithAWarning) {
  const TemporaryFolder folder;
  const SeriesFixture series;
  series.write(folder, 2, "copy of 2");
  const auto file = open_all(folder, series);
  EXPECT_EQ(values_of(*file), expected_values(series));
  ASSERT_EQ(file->header().warnings.size(), 1u);
  EXPECT_NE(file->header().warnings[0].find("is a copy"), std::string::npos);
}

TEST(UnitDicomSeries, OneSliceIsAsThickAsItSays) {
  const TemporaryFolder folder;
  const SeriesFixture series;
  const auto file = open_volume(series.write(folder, 0));
  EXPECT_EQ(file->header().geometry.dims(), Vec3i(5, 4, 1));
  EXPECT_DOUBLE_EQ(file->header().geometry.spacing_mm().z, 9);
}

TEST(UnitDicomSeries, OtherFilesInTheFolderDoNotCount) {
  const TemporaryFolder folder;
  const SeriesFixture series;
  folder.write("README", "not an image, but longer than a preamble: " + std::string(200, '.'));
  folder.write("empty", "");
  std::filesystem::create_directory(folder / "below");
  SeriesFixture report;
  report.series += "3";
  report.edit = [](DcmDataset& data, int) {
    for (const DcmTagKey& tag : {DCM_Rows, DCM_Columns, DCM_PixelData})
      data.findAndDeleteElement(tag);
  };
  report.write(folder, 0, "a_report");
  EXPECT_EQ(values_of(*open_all(folder, series)), expected_values(series));
}

}  // namespace
}  // namespace supple::test
