// Images of several frames: the geometry of each comes from its functional groups.
#include <gtest/gtest.h>

#include "tests/support/dicom_fixtures.h"
#include "tests/support/dicom_jpeg2000.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {
namespace {

const std::vector<int> kShuffled = {3, 0, 5, 1, 4, 2};

TEST(UnitDicomFrames, FramesAreSortedByTheirOwnPositionsInEverySyntax) {
  for (const E_TransferSyntax syntax :
       {EXS_LittleEndianImplicit, EXS_BigEndianExplicit, EXS_DeflatedLittleEndianExplicit,
        EXS_RLELossless, EXS_JPEGProcess14SV1, EXS_JPEGLSLossless, EXS_JPEG2000LosslessOnly}) {
    for (const bool shared_orientation : {true, false}) {
      const TemporaryFolder folder;
      SeriesFixture series;
      series.syntax = syntax;
      write_enhanced(folder / "enhanced.bin", series, kShuffled, shared_orientation);
      const auto file = open_volume(folder / "enhanced.bin");
      expect_geometry(file->header().geometry, series.geometry());
      EXPECT_EQ(values_of(*file), expected_values(series)) << DcmXfer(syntax).getXferName();
    }
  }
}

TEST(UnitDicomFrames, Jpeg2000FramesInSeveralFragmentsAreToldApart) {
  const TemporaryFolder folder;
  SeriesFixture series;
  series.edit = [](DcmDataset& data, int) { compress_jpeg2000(data, EXS_JPEG2000, 32); };
  series.syntax = EXS_JPEG2000;
  write_enhanced(folder / "a", series, kShuffled);
  EXPECT_EQ(values_of(*open_volume(folder / "a")), expected_values(series));
}

TEST(UnitDicomFrames, EightBitFramesOfOddSizeAreToldApart) {
  for (const E_TransferSyntax syntax : {EXS_LittleEndianExplicit, EXS_BigEndianExplicit}) {
    for (const bool bytes_in_words : {false, true}) {
      const TemporaryFolder folder;
      SeriesFixture series;
      series.dims = {5, 3, 6};
      series.syntax = syntax;
      series.bits_allocated = series.bits_stored = 8;
      series.is_signed = false;
      series.bytes_in_words = bytes_in_words;
      series.value = [](int i, int j, int k) { return 30 * k + 7 * j + i; };
      write_enhanced(folder / "a", series, kShuffled);
      EXPECT_EQ(values_of(*open_volume(folder / "a")), expected_values(series))
          << DcmXfer(syntax).getXferName() << bytes_in_words;
    }
  }
}

TEST(UnitDicomFrames, ARescalePerFrameIsFoundInItsGroup) {
  const TemporaryFolder folder;
  SeriesFixture series;
  series.edit = [](DcmDataset& data, int) {
    for (int f = 0; f < 6; ++f) {
      DcmItem *frame = nullptr, *group = nullptr;
      data.findAndGetSequenceItem(DCM_PerFrameFunctionalGroupsSequence, frame, f);
      frame->findOrCreateSequenceItem(DCM_PixelValueTransformationSequence, group, -2);
      put(*group, DCM_RescaleSlope, std::to_string(kShuffled[std::size_t(f)] + 1));
      put(*group, DCM_RescaleIntercept, "-7");
    }
  };
  write_enhanced(folder / "a", series, kShuffled);
  const auto file = open_volume(folder / "a");
  const std::vector<double> stored = expected_values(series), found = values_of(*file);
  ASSERT_EQ(file->header().type, ValueType::float32);
  for (std::size_t n = 0; n < stored.size(); ++n) {
    EXPECT_EQ(found[n], stored[n] * double(n / 20 + 1) - 7);
  }
}

TEST(UnitDicomFrames, ADoseGridIsPlacedByItsOffsetsAndScaledToGray) {
  const TemporaryFolder folder;
  SeriesFixture series;
  series.bits_allocated = series.bits_stored = 32;
  series.is_signed = false;
  series.value = [](int i, int j, int k) { return 100000 * k + 10 * j + i; };
  series.edit = [](DcmDataset& data, int) {
    put(data, DCM_ImagePositionPatient, "-12.5\\30\\-70");
    put(data, DCM_GridFrameOffsetVector, "0\\2\\4\\6\\8\\10");
    put(data, DCM_ImageOrientationPatient, "1\\0\\0\\0\\1\\0");
    put(data, DCM_PixelSpacing, "0.75\\0.5");
    put(data, DCM_DoseGridScaling, "0.125");
    data.findAndDeleteElement(DCM_SharedFunctionalGroupsSequence);
    data.findAndDeleteElement(DCM_PerFrameFunctionalGroupsSequence);
  };
  write_enhanced(folder / "dose", series, {0, 1, 2, 3, 4, 5});
  const auto file = open_volume(folder / "dose");
  expect_geometry(file->header().geometry, series.geometry());
  EXPECT_EQ(values_of(*file), expected_values(series, 0.125));
}

}  // namespace
}  // namespace supple::test
