// The values of DICOM pixels, whatever their transfer syntax and width.
#include <gtest/gtest.h>

#include "tests/support/dicom_fixtures.h"
#include "tests/support/dicom_jpeg2000.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {
namespace {

/// Values of the whole stored range, differing in every bit.
std::function<int(int, int, int)> spread(int bits, bool is_signed) {
  return [bits, is_signed](int i, int j, int k) {
    const auto mixed = std::uint32_t(i + 5 * j + 20 * k) * 2654435761u;
    const std::int64_t value = std::int64_t(mixed >> (32 - bits));
    return int(is_signed ? value - (std::int64_t(1) << (bits - 1)) : value);
  };
}

SeriesFixture fixture_of(int allocated, int stored, bool is_signed) {
  SeriesFixture series;
  series.dims.z = 3;
  series.bits_allocated = allocated;
  series.bits_stored = stored;
  series.is_signed = is_signed;
  series.value = spread(stored, is_signed);
  return series;
}

void expect_values(const SeriesFixture& series, const std::string& what) {
  const TemporaryFolder folder;
  series.write_all(folder);
  const auto file = open_volume(folder / ".");
  EXPECT_EQ(values_of(*file), expected_values(series)) << what;
  EXPECT_EQ(file->header().slope, 1);
  EXPECT_EQ(file->header().intercept, 0);
}

TEST(UnitDicomValues, EveryTransferSyntaxGivesTheSameValues) {
  for (const E_TransferSyntax syntax :
       {EXS_LittleEndianImplicit, EXS_LittleEndianExplicit, EXS_BigEndianExplicit,
        EXS_DeflatedLittleEndianExplicit, EXS_RLELossless, EXS_JPEGProcess14, EXS_JPEGProcess14SV1,
        EXS_JPEGLSLossless, EXS_JPEG2000LosslessOnly, EXS_JPEG2000}) {
    for (const int bits : {8, 16}) {
      // An odd number of pixels, so that 8-bit slices end within a word.
      SeriesFixture series = fixture_of(bits, bits, false);
      series.dims.y = 3;
      series.syntax = syntax;
      expect_values(series, DcmXfer(syntax).getXferName() + std::to_string(bits));
    }
  }
}

TEST(UnitDicomValues, EveryWidthAndSignKeepsItsStoredValues) {
  for (const bool is_signed : {false, true}) {
    for (const int bits : {8, 16, 32}) {
      SeriesFixture series = fixture_of(bits, bits, is_signed);
      if (bits == 32) series.value = [](int i, int j, int k) { return 70000 * (i + j) + k; };
      if (bits == 8) series.value = [](int i, int j, int k) { return i + 2 * j + 10 * k; };
      expect_values(series, std::to_string(bits));
    }
  }
}

TEST(UnitDicomValues, BitsBesideTheStoredOnesAreMaskedAndTheSignIsExtended) {
  for (const bool is_signed : {false, true}) {
    for (const int high_bit : {11, 14}) {
      SeriesFixture series = fixture_of(16, 12, is_signed);
      series.high_bit = high_bit;
      series.edit = [&](DcmDataset& data, int) {
        const Uint16* pixels = nullptr;
        unsigned long count = 0;
        data.findAndGetUint16Array(DCM_PixelData, pixels, &count);
        const Uint16 stored = Uint16(0xFFF << (high_bit - 11));
        std::vector<Uint16> overlaid(pixels, pixels + count);
        for (std::size_t n = 0; n < count; ++n) {
          overlaid[n] = Uint16((overlaid[n] & stored) | (n % 2 == 0 ? Uint16(~stored) : 0));
        }
        data.putAndInsertUint16Array(DCM_PixelData, overlaid.data(), count);
      };
      expect_values(series, std::to_string(high_bit));
    }
  }
}

TEST(UnitDicomValues, TheSignOfAJpeg2000StreamIsThatOfTheAttributes) {
  SeriesFixture series = fixture_of(16, 13, false);
  series.syntax = EXS_JPEG2000;
  series.edit = [](DcmDataset& data, int) {
    compress_jpeg2000(data, EXS_JPEG2000);
    data.putAndInsertUint16(DCM_PixelRepresentation, 1);
  };
  const TemporaryFolder folder;
  series.write_all(folder);
  std::vector<double> expected = expected_values(series);
  for (double& value : expected) value -= value < 4096 ? 0 : 8192;
  EXPECT_EQ(values_of(*open_volume(folder / ".")), expected);
}

TEST(UnitDicomValues, OneRescaleOfAllSlicesLeavesTheStoredValues) {
  const TemporaryFolder folder;
  SeriesFixture series;
  series.edit = [](DcmDataset& data, int) {
    put(data, DCM_RescaleSlope, "0.5");
    put(data, DCM_RescaleIntercept, "-1024");
  };
  series.write_all(folder);
  const auto file = open_volume(folder / ".");
  EXPECT_EQ(file->header().type, ValueType::int16);
  EXPECT_EQ(file->header().slope, 0.5);
  EXPECT_EQ(file->header().intercept, -1024);
  EXPECT_EQ(values_of(*file), expected_values(series, 0.5, -1024));
}

TEST(UnitDicomValues, ARescalePerSliceIsAppliedAndSaid) {
  const TemporaryFolder folder;
  SeriesFixture series;
  series.edit = [](DcmDataset& data, int k) {
    put(data, DCM_RescaleSlope, ds({1 + 0.25 * k}));
    put(data, DCM_RescaleIntercept, ds({double(k)}));
  };
  series.write_all(folder);
  const auto file = open_volume(folder / ".");
  EXPECT_EQ(file->header().type, ValueType::float32);
  EXPECT_EQ(file->header().slope, 1);
  const std::vector<double> stored = expected_values(series), found = values_of(*file);
  for (std::size_t n = 0; n < stored.size(); ++n) {
    const double k = double(n / 20);
    EXPECT_EQ(found[n], stored[n] * (1 + 0.25 * k) + k);
  }
  ASSERT_EQ(file->header().warnings.size(), 1u);
  EXPECT_NE(file->header().warnings[0].find("RescaleSlope"), std::string::npos);
}

TEST(UnitDicomValues, TheBrighterPixelOfMonochrome1HasTheLargerValue) {
  for (const bool is_signed : {false, true}) {
    const TemporaryFolder folder;
    SeriesFixture series = fixture_of(16, 12, is_signed);
    series.edit = [](DcmDataset& data, int) {
      put(data, DCM_PhotometricInterpretation, "MONOCHROME1");
      put(data, DCM_RescaleSlope, "2");
    };
    series.write_all(folder);
    const auto file = open_volume(folder / ".");
    EXPECT_EQ(values_of(*file), expected_values(series, -2, is_signed ? -2 : 2 * 4095));
    EXPECT_EQ(file->header().warnings.size(), 1u);
  }
}

TEST(UnitDicomValues, LossyCompressionIsSaid) {
  const TemporaryFolder folder;
  SeriesFixture series = fixture_of(8, 8, false);
  series.syntax = EXS_JPEGProcess1;
  series.dims = {16, 16, 3};
  series.value = [](int i, int, int k) { return 4 * i + 20 * k; };
  series.write_all(folder);
  const auto file = open_volume(folder / ".");
  const std::vector<double> found = values_of(*file), expected = expected_values(series);
  for (std::size_t n = 0; n < found.size(); ++n) EXPECT_NEAR(found[n], expected[n], 6);
  // DCMTK's encoder rescales each slice, which is said first.
  ASSERT_FALSE(file->header().warnings.empty());
  EXPECT_EQ(file->header().warnings.back(), "the values were compressed with loss");
}

}  // namespace
}  // namespace supple::test
