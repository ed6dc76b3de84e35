// Meaning of datasets of an HDF5 file: ITK images, NeXus, and attributes of plain datasets.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/io_fixtures.h"
#include "tests/volumes/io/hdf5_fixtures.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {
namespace {

const std::string kImage = "/ITKImage/0/";

/// 4 x 3 x 2 voxels of 0.5 x 2 x 3 mm: i along P, j along R, k along S.
void put_image(Hdf5Fixture& file, const std::vector<hsize_t>& dims = {2, 3, 4}) {
  std::size_t count = 1;
  for (const hsize_t size : dims) count *= size;
  file.dataset(kImage + "VoxelData", dims, counting<std::int16_t>(count));
  file.dataset(kImage + "Dimension", {3}, std::vector<std::uint64_t>{4, 3, 2});
  file.numbers(kImage + "Origin", {10, -20, 30});
  file.numbers(kImage + "Spacing", {0.5, 2, 3});
  file.dataset(kImage + "Directions", {3, 3}, std::vector<double>{0, 1, 0, -1, 0, 0, 0, 0, 1});
}

Vec3d spacing_of(const std::string& path) {
  return open_volume(path)->header().geometry.spacing_mm();
}

std::string warnings_of(const std::string& path) {
  const auto file = open_volume(path);
  std::string text;
  for (const std::string& warning : file->header().warnings) text += warning + "\n";
  return text;
}

/// 4 x 3 x 2 voxels in "v"; `describe` adds attributes.
template <class Describe>
std::string plain(const TemporaryFolder& folder, Describe&& describe) {
  Hdf5Fixture file(folder / "p.h5");
  file.dataset("v", {2, 3, 4}, counting<float>(24));
  describe(file);
  return folder / "p.h5";
}

TEST(UnitHdf5Itk, RowsOfDirectionsAreTheAxes) {
  const TemporaryFolder folder;
  {
    Hdf5Fixture file(folder / "a.h5");
    put_image(file);
    file.dataset("other", {2, 2, 2}, counting<float>(8));
  }
  for (const char* path : {"a.h5", "a.h5:/ITKImage/0/VoxelData"}) {
    const auto file = open_volume(folder / path);
    const Geometry& geometry = file->header().geometry;
    EXPECT_EQ(geometry.dims(), Vec3i(4, 3, 2));
    EXPECT_EQ(geometry.origin_lps_mm(), Vec3d(10, -20, 30));
    EXPECT_EQ(geometry.axes_mm()[0], Vec3d(0, 0.5, 0));
    EXPECT_EQ(geometry.axes_mm()[1], Vec3d(-2, 0, 0));
    EXPECT_EQ(geometry.axes_mm()[2], Vec3d(0, 0, 3));
    EXPECT_EQ(read_all(*file), bytes_of_values(counting<std::int16_t>(24)));
    EXPECT_TRUE(file->header().warnings.empty());
  }
}

TEST(UnitHdf5Itk, AnAxisMoreThanDimensionHoldsTheComponents) {
  const TemporaryFolder folder;
  {
    Hdf5Fixture file(folder / "a.h5");
    put_image(file, {2, 3, 4, 3});
  }
  EXPECT_NE(failure_of(folder / "a.h5").find("3 components per voxel"), std::string::npos);
  ReadOptions options;
  options.channel = 1;
  std::vector<std::int16_t> seconds;
  for (int n = 0; n < 24; ++n) seconds.push_back(std::int16_t(3 * n + 1));
  EXPECT_EQ(read_all(*open_volume(folder / "a.h5", options)), bytes_of_values(seconds));
}

TEST(UnitHdf5Itk, ImagesOfTwoAndFourDimensionsKeepTheirGeometry) {
  const TemporaryFolder folder;
  {
    Hdf5Fixture file(folder / "flat.h5");
    file.dataset(kImage + "VoxelData", {2, 3}, counting<float>(6));
    file.dataset(kImage + "Dimension", {2}, std::vector<std::uint64_t>{3, 2});
    file.numbers(kImage + "Origin", {5, 6});
    file.numbers(kImage + "Spacing", {2, 3});
    file.dataset(kImage + "Directions", {2, 2}, std::vector<double>{0, 1, 1, 0});
  }
  const auto flat = open_volume(folder / "flat.h5");
  EXPECT_EQ(flat->header().geometry.dims(), Vec3i(3, 2, 1));
  EXPECT_EQ(flat->header().geometry.axes_mm()[1], Vec3d(3, 0, 0));
  EXPECT_EQ(read_all(*flat), bytes_of_values(counting<float>(6)));
  {
    Hdf5Fixture file(folder / "series.h5");
    file.dataset(kImage + "VoxelData", {2, 1, 2, 3}, counting<float>(12));
    file.dataset(kImage + "Dimension", {4}, std::vector<std::uint64_t>{3, 2, 1, 2});
    file.numbers(kImage + "Origin", {5, 6, 7, 0});
    file.numbers(kImage + "Spacing", {2, 3, 4, 1});
    file.dataset(kImage + "Directions", {4, 4},
                 std::vector<double>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1});
  }
  ReadOptions options;
  options.frame = 1;
  const auto series = open_volume(folder / "series.h5", options);
  EXPECT_EQ(series->header().geometry.dims(), Vec3i(3, 2, 1));
  EXPECT_EQ(series->header().geometry.axes_mm()[2], Vec3d(0, 0, -4));
  EXPECT_EQ(read_all(*series), bytes_of_values(std::vector<float>{6, 7, 8, 9, 10, 11}));
}

TEST(UnitHdf5Plain, AttributesGiveTheSpacingInTheOrderOfTheAxes) {
  const TemporaryFolder folder;
  const std::vector<double> kji = {3, 2, 0.5};
  const auto with = [&](const std::string& name, const std::vector<double>& values,
                        const std::string& unit = "") {
    return spacing_of(plain(folder, [&](Hdf5Fixture& file) {
      file.attribute("v", name, values);
      if (!unit.empty()) file.text_attribute("v", "units", unit);
    }));
  };
  const auto expect_near = [](const Vec3d& found, const Vec3d& expected) {
    EXPECT_LT((found - expected).length(), 1e-12) << found;
  };
  expect_near(with("element_size_um", kji), {0.0005, 0.002, 0.003});
  expect_near(with("spacing", kji), {0.5, 2, 3});
  expect_near(with("voxel_size", kji), {0.5, 2, 3});
  expect_near(with("voxel_size", kji, "um"), {0.0005, 0.002, 0.003});
  expect_near(with("resolution", {4000, 400, 40}, "nm"), {4e-5, 4e-4, 4e-3});
  expect_near(with("resolution", {4000, 400, 40}), {1, 1, 1});
  expect_near(with("spacing", {0.25}), {0.25, 0.25, 0.25});
  expect_near(with("nothing", kji), {1, 1, 1});
}

TEST(UnitHdf5Plain, MissingVoxelSizesAreWarnedOfUnlessTheUserGivesThem) {
  const TemporaryFolder folder;
  const std::string path = plain(folder, [](Hdf5Fixture&) {});
  EXPECT_NE(warnings_of(path).find("1 mm is taken"), std::string::npos);
  ReadOptions options;
  options.spacing_mm = Vec3d(2, 3, 4);
  const auto file = open_volume(path, options);
  EXPECT_TRUE(file->header().warnings.empty());
  EXPECT_EQ(file->header().geometry.spacing_mm(), Vec3d(2, 3, 4));
  const TemporaryFolder other;
  const std::string nanometres = plain(other, [](Hdf5Fixture& out) {
    out.attribute("v", "resolution", {40, 4, 4});
  });
  EXPECT_NE(warnings_of(nanometres).find("resolution has no units"), std::string::npos);
}

/// An NXtomo entry as beamlines write it; the data linked from the detector.
std::string tomography(const TemporaryFolder& folder, const std::string& unit) {
  Hdf5Fixture file(folder / "a.nxs");
  file.dataset("entry/instrument/detector/data", {2, 3, 4}, counting<std::uint16_t>(24));
  file.dataset("entry/instrument/detector/flats", {2, 3, 4}, counting<std::uint16_t>(24));
  file.group("entry/data");
  H5Lcreate_soft("/entry/instrument/detector/data", file.get(), "/entry/data/data", H5P_DEFAULT,
                 H5P_DEFAULT);
  file.text_attribute("/entry", "NX_class", "NXentry");
  file.text_attribute("/entry/data", "NX_class", "NXdata");
  file.text_attribute("/entry/instrument", "NX_class", "NXinstrument");
  file.text_attribute("/entry/instrument/detector", "NX_class", "NXdetector");
  for (const std::string axis : {"x", "y"}) {
    const std::string name = "/entry/instrument/detector/" + axis + "_pixel_size";
    file.numbers(name, {axis == "x" ? 0.5 : 0.75});
    if (!unit.empty()) file.text_attribute(name, "units", unit);
  }
  return folder / "a.nxs";
}

TEST(UnitHdf5Nexus, TheDataOfTheEntryComeWithTheDetectorsPixelSizes) {
  const TemporaryFolder folder;
  const std::string path = tomography(folder, "um");
  for (const char* name : {"", ":/entry/data/data", ":/entry/instrument/detector/data"}) {
    const auto file = open_volume(path + name);
    EXPECT_LT((file->header().geometry.spacing_mm() - Vec3d(5e-4, 7.5e-4, 7.5e-4)).length(), 1e-15);
    EXPECT_EQ(read_all(*file), bytes_of_values(counting<std::uint16_t>(24)));
  }
  EXPECT_NE(warnings_of(path).find("no z_pixel_size"), std::string::npos);
  EXPECT_NE(failure_of(tomography(folder, "")).find("x_pixel_size: found no units"),
            std::string::npos);
  EXPECT_NE(failure_of(tomography(folder, "furlong")).find("found furlong, expected nm, um, mm"),
            std::string::npos);
}

TEST(FaultHdf5Layout, WhatContradictsItselfIsRefused) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& name, const std::vector<double>& values,
                          const std::string& part) {
    {
      Hdf5Fixture file(folder / "a.h5");
      put_image(file);
      H5Ldelete(file.get(), (kImage + name).c_str(), H5P_DEFAULT);
      if (name == "Directions") {
        file.dataset(kImage + name, {3, 3}, values);
      } else {
        file.numbers(kImage + name, values);
      }
    }
    const std::string line = failure_of(folder / "a.h5");
    EXPECT_NE(line.find(part), std::string::npos) << line;
  };
  const double nan = std::nan(""), inf = HUGE_VAL;
  expect("Directions", {0, 1, 0, 0, 1, 0, 0, 0, 1}, "independent");
  expect("Directions", {0, nan, 0, 0, 1, 0, 0, 0, 1}, "direction");
  expect("Origin", {0, 0, inf}, "origin");
  expect("Origin", {0, 0}, "Origin: found 2 numbers, expected 3");
  expect("Spacing", {1, 0, 1}, "Spacing: found 0");
  expect("Spacing", {1, -1, 1}, "Spacing: found -1");
  expect("Spacing", {1, nan, 1}, "Spacing: found nan");
  expect("Spacing", {1, inf, 1}, "direction");
  expect("Dimension", {4, 3, 3}, "VoxelData: found other sizes");
  expect("Dimension", {4, 3, nan}, "VoxelData: found other sizes");
  expect("Dimension", {4, 3, 2, 1, 1}, "found 5 sizes");
}

TEST(FaultHdf5Layout, AttributesThatAreNoVoxelSizesAreRefused) {
  const TemporaryFolder folder;
  const auto failure = [&](const std::vector<double>& values) {
    return failure_of(
        plain(folder, [&](Hdf5Fixture& file) { file.attribute("v", "element_size_um", values); }));
  };
  EXPECT_NE(failure({0, 1, 1}).find("element_size_um: found 0"), std::string::npos);
  EXPECT_NE(failure({1, std::nan(""), 1}).find("element_size_um: found nan"), std::string::npos);
  EXPECT_NE(failure({1, 1}).find("element_size_um: found 2 numbers"), std::string::npos);
  EXPECT_NE(failure(std::vector<double>(17, 1)).find("17 numbers"), std::string::npos);
  const std::string text = plain(
      folder, [](Hdf5Fixture& file) { file.text_attribute("v", "element_size_um", "small"); });
  EXPECT_NE(failure_of(text).find("found no numbers"), std::string::npos);
}

}  // namespace
}  // namespace supple::test
