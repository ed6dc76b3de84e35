// Files of other programs that were misread without a word: units by all their names, directions
// that 3D Slicer records, calibrations of ImageJ, triples that are no displacement.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/errors.h"
#include "tests/support/io_fixtures.h"
#include "tests/volumes/io/tiff_fixtures.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/mesh/triangle_mesh.h"
#include "volumes/io/point_file.h"
#include "volumes/io/volume_writer.h"
#include "volumes/io/warp_file.h"

namespace supple::test {
namespace {

std::string quoted_three(const std::string& unit) {
  return "\"" + unit + "\" \"" + unit + "\" \"" + unit + "\"\n";
}

std::string shorts() {
  return bytes_of_values(std::vector<std::int16_t>(24, 7));
}

TEST(UnitMisread, LengthsOfNrrdCountByEveryNameOfTheirUnit) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, double>> units = {
      {"mm", 1},           {"millimeters", 1},  {"Millimetre", 1},    {"cm", 10},
      {"centimeters", 10}, {"m", 1000},         {"meters", 1000},     {"um", 1e-3},
      {"micron", 1e-3},    {"microns", 1e-3},   {"micrometer", 1e-3}, {"micrometers", 1e-3},
      {"\xc2\xb5m", 1e-3}, {"\xce\xbcm", 1e-3}, {"nm", 1e-6},         {"nanometers", 1e-6},
      {"in", 25.4},        {"inch", 25.4},      {"inches", 25.4},     {"", 1}};
  const std::string head =
      "NRRD0004\ntype: int16\ndimension: 3\nsizes: 4 3 2\nendian: little\nencoding: raw\n";
  for (const auto& [unit, mm] : units) {
    const std::string in_space =
        "space: LPS\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace units: ";
    for (const std::string& fields :
         {in_space + quoted_three(unit), "spacings: 2 3 4\nunits: " + quoted_three(unit)}) {
      const auto file = open_volume(folder.write("a.nrrd", head + fields + "\n" + shorts()));
      const Vec3d spacing = file->header().geometry.spacing_mm();
      EXPECT_LT((spacing - Vec3d(2, 3, 4) * mm).length(), 1e-12 * mm) << unit << spacing;
      EXPECT_TRUE(file->header().warnings.empty()) << unit;
    }
  }
}

TEST(UnitMisread, AUnitThatIsNoLengthIsWarnedOf) {
  const TemporaryFolder folder;
  for (const char* unit : {"pixel", "furlong", "light year"}) {
    const auto file = open_volume(
        folder.write("a.nrrd",
                     "NRRD0004\ntype: int16\ndimension: 3\nsizes: 4 3 2\nendian: little\n"
                     "encoding: raw\nspace: LPS\nspace directions: (2,0,0) (0,3,0) (0,0,4)\n"
                     "space units: " +
                         quoted_three(unit) + "\n" + shorts()));
    EXPECT_EQ(file->header().geometry.spacing_mm(), Vec3d(2, 3, 4));
    ASSERT_EQ(file->header().warnings.size(), 1u) << unit;
    EXPECT_NE(file->header().warnings[0].find(unit), std::string::npos);
  }
  const auto meta = open_volume(
      folder.write("a.mha",
                   "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = MET_SHORT\n"
                   "DistanceUnits = um\nElementSpacing = 2 3 4\nElementDataFile = LOCAL\n" +
                       shorts()));
  ASSERT_EQ(meta->header().warnings.size(), 1u);
  EXPECT_NE(meta->header().warnings[0].find("um"), std::string::npos);
}

std::string imagej(const std::string& lines) {
  return "ImageJ=1.53t\nimages=2\nslices=2\nspacing=0.25\nunit=mm\n" + lines;
}

std::unique_ptr<VolumeFile> open_imagej(const TemporaryFolder& folder, const std::string& lines) {
  TiffOptions options;
  options.description = imagej(lines);
  options.bits = 16;
  options.x_resolution = options.y_resolution = 2;
  options.resolution_unit = 1;
  write_tiff_pages(folder / "a.tif", 2, 2, options, lettered_pages(2, 8));
  return open_volume(folder / "a.tif");
}

TEST(UnitMisread, AStraightCalibrationOfImageJIsApplied) {
  const TemporaryFolder folder;
  const auto hu = open_imagej(folder, "cf=0\nc0=-1024\nc1=0.5\nvunit=gray value\n");
  EXPECT_EQ(hu->header().intercept, -1024);
  EXPECT_EQ(hu->header().slope, 0.5);
  const auto plain = open_imagej(folder, "");
  EXPECT_EQ(plain->header().intercept, 0);
  EXPECT_EQ(plain->header().slope, 1);
  EXPECT_TRUE(plain->header().warnings.empty());
}

TEST(UnitMisread, OtherCalibrationsOfImageJAreWarnedOf) {
  const TemporaryFolder folder;
  const auto file = open_imagej(folder, "cf=4\nc0=1\nc1=2\n");
  EXPECT_EQ(file->header().slope, 1);
  ASSERT_EQ(file->header().warnings.size(), 1u);
  EXPECT_NE(file->header().warnings[0].find("calibration function 4"), std::string::npos);
}

TEST(UnitMisread, AxesOfImageJMayHaveUnitsOfTheirOwn) {
  const TemporaryFolder folder;
  const auto file = open_imagej(folder, "yunit=cm\nzunit=um\n");
  const Vec3d spacing = file->header().geometry.spacing_mm();
  EXPECT_LT((spacing - Vec3d(0.5, 5, 0.25e-3)).length(), 1e-12) << spacing;
}

constexpr int kVectors = 12;  // of 3 x 2 x 2 voxels

std::string warp_head(const std::string& kind, const std::string& type, const std::string& more) {
  return "NRRD0005\ntype: " + type +
         "\ndimension: 4\nsizes: 3 3 2 2\nendian: little\nencoding: raw\nkinds: " + kind +
         " domain domain domain\nspace: left-posterior-superior\n"
         "space directions: none (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n" +
         more + "\n";
}

std::string floats() {
  return bytes_of_values(std::vector<float>(3 * kVectors, 1.5f));
}

TEST(UnitMisread, SlicersTypeOfADisplacementFieldIsItsDirection) {
  const TemporaryFolder folder;
  const auto direction_of = [&](const std::string& keys) {
    return read_warp(folder.write("a.nrrd", warp_head("vector", "float", keys) + floats()))
        .direction;
  };
  EXPECT_EQ(direction_of("displacement field type:=modeling\n"), WarpDirection::material);
  EXPECT_EQ(direction_of("displacement field type:=resampling\n"), WarpDirection::resample);
  EXPECT_EQ(direction_of("displacement field type:= Modeling \n"), WarpDirection::material);
  EXPECT_FALSE(direction_of("").has_value());
  const auto refused = [&](const std::string& keys, const std::string& part) {
    folder.write("a.nrrd", warp_head("vector", "float", keys) + floats());
    EXPECT_NE(failure_of_warp(folder / "a.nrrd").find(part), std::string::npos)
        << failure_of_warp(folder / "a.nrrd");
  };
  refused("displacement field type:=sideways\n", "sideways");
  refused("supple direction:=resample\ndisplacement field type:=modeling\n", "modeling");
}

TEST(UnitMisread, SlicerIsToldTheDirectionOfAWarp) {
  const TemporaryFolder folder;
  const Geometry grid({3, 2, 2}, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  const auto slices = [](int, Vec3f* out) { std::fill_n(out, 6, Vec3f(1, 2, 3)); };
  write_warp(folder / "m.nrrd", {grid, WarpDirection::material}, slices);
  write_warp(folder / "r.nhdr", {grid, WarpDirection::resample}, slices);
  EXPECT_NE(read_text(folder / "m.nrrd").find("\ndisplacement field type:=modeling\n"),
            std::string::npos);
  EXPECT_NE(read_text(folder / "r.nhdr").find("\ndisplacement field type:=resampling\n"),
            std::string::npos);
}

TEST(UnitMisread, TriplesThatAreNoDisplacementAreNoWarp) {
  const TemporaryFolder folder;
  const auto expect_none = [&](const std::string& path) {
    EXPECT_NE(failure_of_warp(path).find("no displacement"), std::string::npos)
        << path << ": " << failure_of_warp(path);
  };
  for (const char* kind : {"3-normal", "normal", "3-gradient", "covariant-vector", "point",
                           "RGB-color", "HSV-color", "XYZ-color", "2D-symmetric-matrix"}) {
    expect_none(folder.write("a.nrrd", warp_head(kind, "float", "") + floats()));
  }
  const std::string bytes(3 * kVectors, 'x');
  expect_none(folder.write("b.nrrd", warp_head("vector", "uchar", "") + bytes));
  expect_none(folder.write("c.nrrd", warp_head("none", "uchar", "") + bytes));
  expect_none(folder.write("d.mha",
                           "ObjectType = Image\nNDims = 3\nDimSize = 3 2 2\n"
                           "ElementType = MET_UCHAR\nElementNumberOfChannels = 3\n"
                           "ElementDataFile = LOCAL\n" +
                               bytes));
  std::string rgb = nifti_header({3, 2, 2});
  patch(rgb, 70, std::int16_t(128));
  patch(rgb, 72, std::int16_t(24));
  expect_none(folder.write("e.nii", rgb + bytes));
  std::string points = nifti_header({3, 2, 2, 1, 3});
  patch(points, 68, std::int16_t(1008));  // NIFTI_INTENT_POINTSET
  patch(points, 70, std::int16_t(16));
  patch(points, 72, std::int16_t(32));
  expect_none(folder.write("f.nii", points + floats()));
  for (const char* name : {"Mapping", "NREG_TRANS"}) {  // places in mm, of SPM and NiftyReg
    std::string places = points;
    patch(places, 68, std::int16_t(1007));
    places.replace(328, std::string(name).size(), name);
    expect_none(folder.write("h.nii", places + floats()));
  }
  TiffOptions colour;
  colour.samples = 3;
  colour.photometric = 2;
  write_tiff(folder / "g.tif", 3, 2, colour, std::string(18, 'x'));
  expect_none(folder / "g.tif");
}

TEST(UnitMisread, ASequenceOfSlicerHasFramesHoweverFewTheyAre) {
  const TemporaryFolder folder;
  std::vector<std::int16_t> values;
  for (int n = 0; n < 3 * kVectors; ++n) values.push_back(std::int16_t(n % 3 + 1));
  const std::string sequence =
      "DataNodeClassName:=vtkMRMLScalarVolumeNode\naxis 0 index type:=numeric\n"
      "axis 0 index values:=0 1 2\n";
  const std::string path =
      folder.write("a.seq.nrrd", warp_head("list", "short", sequence) + bytes_of_values(values));
  EXPECT_NE(failure_of_warp(path), "");
  EXPECT_NE(failure_of(path).find("3 frames"), std::string::npos) << failure_of(path);
  EXPECT_EQ(read_all(*open_volume(path, choice(2))),
            bytes_of_values(std::vector<std::int16_t>(kVectors, 3)));
}

TEST(UnitMisread, FiducialListsOfSlicerAreRasUnlessTheySayOtherwise) {
  const TemporaryFolder folder;
  const auto first = [&](const std::string& name, const std::string& text) {
    return read_point_file(folder.write(name, text)).rows.at(0).at_lps_mm;
  };
  const std::string list = "# Fiducial List file F.fcsv\n# version = 2\n# name = F\n";
  const std::string columns = "# columns = label,x,y,z,sel,vis\n", row = "F-1,-8,-9,7,1,1\n";
  EXPECT_EQ(first("a.fcsv", list + columns + row), Vec3d(8, 9, 7));
  EXPECT_EQ(first("a.fcsv", list + row), Vec3d(8, 9, 7));  // columns are those of Slicer 3
  EXPECT_EQ(first("a.csv", list + columns + row), Vec3d(8, 9, 7));
  EXPECT_EQ(first("a.fcsv", "# Markups fiducial file version = 4.0\n" + columns + row),
            Vec3d(8, 9, 7));
  EXPECT_EQ(first("a.fcsv", list + "# CoordinateSystem = LPS\n" + columns + row), Vec3d(-8, -9, 7));
  EXPECT_EQ(first("a.csv", columns + row), Vec3d(-8, -9, 7));
}

TEST(UnitMisread, OnesOwnSpacingStandsInForWhatAFileLacks) {
  const TemporaryFolder folder;
  ReadOptions options;
  options.spacing_mm = Vec3d(2, 3, 4);
  std::string nifti = nifti_header({4, 3, 2});
  for (int a = 0; a < 4; ++a) patch(nifti, std::size_t(76 + 4 * a), 0.0f);
  const std::string head =
      "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = MET_SHORT\n";
  const std::string paths[] = {
      folder.write("a.nii", nifti + shorts()),
      folder.write("b.nrrd",
                   "NRRD0004\ntype: int16\ndimension: 3\nsizes: 4 3 2\nendian: little\n"
                   "encoding: raw\nspacings: nan nan nan\n\n" +
                       shorts()),
      folder.write("c.mha", head + "ElementSpacing = 0 0 0\nElementDataFile = LOCAL\n" + shorts())};
  for (const std::string& path : paths) {
    EXPECT_NE(failure_of(path), "") << path;
    EXPECT_EQ(failure_of(path, options), "") << path;
    EXPECT_EQ(open_volume(path, options)->header().geometry.spacing_mm(), Vec3d(2, 3, 4));
  }
}

TEST(UnitMisread, ACutBinaryStlThatBeginsWithSolidIsToldByItsLength) {
  const TemporaryFolder folder;
  std::string bytes = "solid part" + std::string(70, ' ') + bytes_of_value(std::uint32_t(2));
  bytes += std::string(50, '\0');
  const std::string path = folder.write("a.stl", bytes);
  const std::string line = input_error([&] { read_mesh(path); });
  EXPECT_NE(line.find("134 bytes, expected 184 bytes"), std::string::npos) << line;
}

}  // namespace
}  // namespace supple::test
