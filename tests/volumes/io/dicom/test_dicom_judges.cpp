// pydicom reads the values and places of the same files, plastimatch the same series as a volume,
// GDCM writes JPEG 2000.
// Each judge is skipped where it is not installed (tools/setup.sh --with-judges).
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/support/dicom_fixtures.h"
#include "tests/support/program.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {
namespace {

SeriesFixture oblique_with_rescale(E_TransferSyntax syntax) {
  SeriesFixture series;
  series.row = {0.8, 0.6, 0};
  series.column = {0, 0, -1};
  series.step = series.row.cross(series.column) * 1.5;
  series.syntax = syntax;
  series.edit = [](DcmDataset& data, int) {
    put(data, DCM_RescaleSlope, "2");
    put(data, DCM_RescaleIntercept, "-1000");
  };
  return series;
}

/// Prints, slice by slice along the normal, the world position and rescaled value of every pixel.
constexpr const char* kPydicomScript = R"(
import sys, os, numpy, pydicom
slices = [pydicom.dcmread(os.path.join(sys.argv[1], n)) for n in os.listdir(sys.argv[1])]
def frame(s):
    o = numpy.array(s.ImageOrientationPatient, float)
    return o[:3], o[3:], numpy.array(s.ImagePositionPatient, float)
slices.sort(key=lambda s: numpy.dot(numpy.cross(*frame(s)[:2]), frame(s)[2]))
for s in slices:
    row, column, position = frame(s)
    values = s.pixel_array * float(s.RescaleSlope) + float(s.RescaleIntercept)
    for r in range(s.Rows):
        for c in range(s.Columns):
            p = position + row * c * s.PixelSpacing[1] + column * r * s.PixelSpacing[0]
            print(*p, values[r, c])
)";

TEST(InteropDicom, PydicomFindsTheSameValueAtTheSamePlace) {
  const std::string python = "/usr/bin/python3";
  if (!runs(python + " -c 'import pydicom, numpy'")) GTEST_SKIP() << "pydicom is not installed";
  for (const E_TransferSyntax syntax : {EXS_LittleEndianImplicit, EXS_BigEndianExplicit,
                                        EXS_DeflatedLittleEndianExplicit, EXS_RLELossless}) {
    const TemporaryFolder folder, outputs;
    oblique_with_rescale(syntax).write_all(folder);
    const std::string script = outputs.write("judge.py", kPydicomScript);
    const std::string list = outputs / "list";
    ASSERT_EQ(std::system((python + " " + script + " " + folder / "." + " >" + list).c_str()), 0);
    std::ifstream lines(list);
    const auto file = open_volume(folder / ".");
    const std::vector<double> values = values_of(*file);
    const Geometry& geometry = file->header().geometry;
    std::size_t n = 0;
    for (Vec3d place; lines >> place.x >> place.y >> place.z; ++n) {
      double value = 0;
      lines >> value;
      ASSERT_LT(n, values.size());
      EXPECT_EQ(value, values[n]);
      const Vec3d ours =
          geometry.world_from_index({double(n % 5), double(n / 5 % 4), double(n / 20)});
      EXPECT_LE((ours - place).length(), 1e-6) << n;
    }
    EXPECT_EQ(n, values.size());
  }
}

TEST(InteropDicom, WhatGdcmWritesInJpeg2000HasTheValuesThatItWasGiven) {
  if (!runs("gdcmconv --version")) GTEST_SKIP() << "libgdcm-tools is not installed";
  for (const bool is_signed : {false, true}) {
    for (const int bits : {8, 12, 16}) {
      const TemporaryFolder folder, packed;
      SeriesFixture series;
      series.dims = {64, 48, 3};  // GDCM 3.0.21 crashes on streams that are longer than the values
      series.bits_allocated = bits == 8 ? 8 : 16;
      series.bits_stored = bits;
      series.is_signed = is_signed;
      const int offset = is_signed ? 1 << (bits - 1) : 0;
      series.value = [=](int i, int j, int k) {
        return (i * j * 37 + i * 11 + k * 5) % (1 << bits) - offset;
      };
      series.write_all(folder);
      write_enhanced(folder / "frames", series, {2, 0, 1});
      for (const char* kind : {"", "--irreversible -q 60"}) {
        for (int k = 0; k < 3; ++k) {
          const std::string name = series.file_name(k);
          ASSERT_TRUE(runs("gdcmconv --j2k " + std::string(kind) + " " + (folder / name) + " " +
                           (packed / name)));
        }
        const auto file = open_volume(packed / ".");
        const std::vector<double> found = values_of(*file), expected = expected_values(series);
        double apart = 0;
        for (std::size_t n = 0; n < expected.size(); ++n) {
          apart = std::max(apart, std::abs(found[n] - expected[n]));
        }
        EXPECT_LE(apart, *kind == 0 ? 0 : 0.1 * (1 << bits)) << bits << is_signed << kind;
        EXPECT_EQ(file->header().type, series.bits_allocated == 8
                                           ? (is_signed ? ValueType::int8 : ValueType::uint8)
                                           : (is_signed ? ValueType::int16 : ValueType::uint16));
      }
      ASSERT_TRUE(runs("gdcmconv --j2k " + (folder / "frames") + " " + (packed / "frames")));
      EXPECT_EQ(values_of(*open_volume(packed / "frames")), expected_values(series)) << bits;
    }
  }
}

TEST(InteropDicom, PlastimatchMakesTheSameVolume) {
  if (!runs("plastimatch --version")) GTEST_SKIP() << "plastimatch is not installed";
  for (const E_TransferSyntax syntax : {EXS_LittleEndianExplicit, EXS_LittleEndianImplicit}) {
    const TemporaryFolder folder, outputs;
    oblique_with_rescale(syntax).write_all(folder);
    const std::string image = outputs / "image.nrrd";
    ASSERT_TRUE(runs("plastimatch convert --input " + folder / "." + " --output-img " + image));
    const auto ours = open_volume(folder / "."), theirs = open_volume(image);
    expect_geometry(ours->header().geometry, theirs->header().geometry, 1e-4);
    EXPECT_EQ(values_of(*ours), values_of(*theirs));
  }
}

}  // namespace
}  // namespace supple::test
