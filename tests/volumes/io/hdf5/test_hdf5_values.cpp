// Values of HDF5 datasets: axes, types, chunks, filters, fill values, frames, choice by path.
#include <array>
#include <filesystem>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/io_fixtures.h"
#include "tests/support/sanitized.h"
#include "tests/volumes/io/hdf5_fixtures.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {
namespace {

/// Writes values that count up in one type and byte order and expects them back.
template <class T>
void expect_counting(ValueType type, hid_t little, hid_t big) {
  const TemporaryFolder folder;
  for (const hid_t file_type : {little, big}) {
    const std::string path = folder / "a.h5";
    Hdf5Fixture(path).dataset("v", {2, 3, 4}, counting<T>(24), {file_type});
    const auto file = open_volume(path);
    EXPECT_EQ(file->header().type, type);
    EXPECT_EQ(read_all(*file), bytes_of_values(counting<T>(24))) << numpy_name(type);
  }
}

TEST(UnitHdf5, TheLastAxisIsIAndTheFirstIsK) {
  const TemporaryFolder folder;
  Hdf5Fixture(folder / "a.h5").dataset("v", {2, 3, 4}, counting<std::int16_t>(24));
  const auto file = open_volume(folder / "a.h5");
  EXPECT_EQ(file->header().format, "hdf5");
  EXPECT_EQ(file->header().geometry.dims(), Vec3i(4, 3, 2));
  EXPECT_EQ(read_all(*file), bytes_of_values(counting<std::int16_t>(24)));
  Hdf5Fixture(folder / "b.h5").dataset("v", {3, 4}, counting<float>(12));
  const auto flat = open_volume(folder / "b.h5");
  EXPECT_EQ(flat->header().geometry.dims(), Vec3i(4, 3, 1));
  EXPECT_EQ(read_all(*flat), bytes_of_values(counting<float>(12)));
}

TEST(UnitHdf5, EveryTypeInEitherByteOrderComesInNativeForm) {
  expect_counting<std::int8_t>(ValueType::int8, H5T_STD_I8LE, H5T_STD_I8BE);
  expect_counting<std::uint8_t>(ValueType::uint8, H5T_STD_U8LE, H5T_STD_U8BE);
  expect_counting<std::int16_t>(ValueType::int16, H5T_STD_I16LE, H5T_STD_I16BE);
  expect_counting<std::uint16_t>(ValueType::uint16, H5T_STD_U16LE, H5T_STD_U16BE);
  expect_counting<std::int32_t>(ValueType::int32, H5T_STD_I32LE, H5T_STD_I32BE);
  expect_counting<std::uint32_t>(ValueType::uint32, H5T_STD_U32LE, H5T_STD_U32BE);
  expect_counting<std::int64_t>(ValueType::int64, H5T_STD_I64LE, H5T_STD_I64BE);
  expect_counting<std::uint64_t>(ValueType::uint64, H5T_STD_U64LE, H5T_STD_U64BE);
  expect_counting<float>(ValueType::float32, H5T_IEEE_F32LE, H5T_IEEE_F32BE);
  expect_counting<double>(ValueType::float64, H5T_IEEE_F64LE, H5T_IEEE_F64BE);
}

TEST(PropertyHdf5, ChunksAndFiltersDoNotChangeTheValues) {
  std::mt19937 random(1);
  const TemporaryFolder folder;
  for (int n = 0; n < cases(60); ++n) {
    std::vector<hsize_t> dims, chunk;
    for (int a = 0; a < 3; ++a) {
      dims.push_back(1 + random() % 12);
      chunk.push_back(1 + random() % dims.back());
    }
    Hdf5Storage storage{H5T_STD_U16BE, chunk};
    storage.shuffle = n % 2 == 1;
    storage.deflate = n % 3 > 0;
    storage.fletcher = n % 5 == 0;
    const std::size_t count = std::size_t(dims[0] * dims[1] * dims[2]);
    std::vector<std::uint16_t> values(count);
    for (auto& value : values) value = std::uint16_t(random());
    Hdf5Fixture(folder / "a.h5").dataset("v", dims, values, storage);
    EXPECT_EQ(read_all(folder / "a.h5"), bytes_of_values(values)) << n;
  }
}

TEST(UnitHdf5, SzipIsReadWhereTheLibraryHasIt) {
  if (H5Zfilter_avail(H5Z_FILTER_SZIP) <= 0) GTEST_SKIP() << "this HDF5 has no szip";
  const TemporaryFolder folder;
  Hdf5Storage storage{H5T_STD_I32LE, {2, 4, 8}};
  storage.szip = true;
  Hdf5Fixture(folder / "a.h5").dataset("v", {4, 4, 8}, counting<std::int32_t>(128), storage);
  EXPECT_EQ(read_all(folder / "a.h5"), bytes_of_values(counting<std::int32_t>(128)));
}

TEST(UnitHdf5, UnwrittenChunksHoldTheFillValue) {
  const TemporaryFolder folder;
  Hdf5Storage storage{H5T_STD_I16BE, {2, 2, 2}};
  storage.fill = -7;
  Hdf5Fixture(folder / "a.h5").dataset("v", {3, 4, 5}, std::vector<std::int16_t>(), storage);
  EXPECT_EQ(read_all(folder / "a.h5"), bytes_of_values(std::vector<std::int16_t>(60, -7)));
}

TEST(UnitHdf5, AFourthAxisComesFirstAndIsAFrame) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.h5";
  Hdf5Fixture(path).dataset("v", {3, 2, 2, 5}, counting<std::uint8_t>(60),
                            {H5I_INVALID_HID, {2, 2, 1, 3}});
  EXPECT_NE(failure_of(path).find("/v: found 3 frames, expected frame 0 to 2"), std::string::npos);
  for (const int frame : {0, 1, 2}) {
    ReadOptions options;
    options.frame = frame;
    const auto file = open_volume(path, options);
    EXPECT_EQ(file->header().geometry.dims(), Vec3i(5, 2, 2));
    std::vector<std::uint8_t> values(20);
    std::iota(values.begin(), values.end(), std::uint8_t(20 * frame));
    EXPECT_EQ(read_all(*file), bytes_of_values(values));
  }
}

TEST(UnitHdf5, TruthValuesAreTheirIntegersAndHalfFloatsBecomeFloats) {
  const TemporaryFolder folder;
  const hid_t truth = H5Tenum_create(H5T_STD_I8LE), half = H5Tcopy(H5T_IEEE_F32LE);
  const std::int8_t no = 0, yes = 1;
  H5Tenum_insert(truth, "FALSE", &no);
  H5Tenum_insert(truth, "TRUE", &yes);
  H5Tset_fields(half, 15, 10, 5, 0, 10);
  H5Tset_size(half, 2);
  H5Tset_ebias(half, 15);
  {
    Hdf5Fixture file(folder / "a.h5");
    file.dataset("half", {1, 2, 2}, std::vector<float>{1, -2, 0.5f, 65504}, {half});
    file.dataset("mask", {1, 2, 2}, std::vector<std::int8_t>{0, 1, 1, 0}, {truth});
  }
  const auto floats = open_volume(folder / "a.h5" + ":/half");
  EXPECT_EQ(floats->header().type, ValueType::float32);
  EXPECT_EQ(read_all(*floats), bytes_of_values(std::vector<float>{1, -2, 0.5f, 65504}));
  const auto mask = open_volume(folder / "a.h5" + ":/mask");
  EXPECT_EQ(mask->header().type, ValueType::int8);
  EXPECT_EQ(read_all(*mask), bytes_of_values(std::vector<std::int8_t>{0, 1, 1, 0}));
  H5Tclose(truth);
  H5Tclose(half);
}

TEST(UnitHdf5, APathBehindTheFileNameChoosesAndSeveralAreListed) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.h5";
  {
    Hdf5Fixture file(path);
    for (const char* name : {"a", "g/b", "g/h/c", "d", "e", "f"}) {
      file.dataset(name, {1, 1, 1}, std::vector<std::uint8_t>{std::uint8_t(name[0])});
    }
    H5Lcreate_soft("/g/h", file.get(), "/soft", H5P_DEFAULT, H5P_DEFAULT);
  }
  EXPECT_NE(failure_of(path).find("datasets: found 6: /a, /d, /e, /f, /g/b and 1 more, expected "
                                  "one of them named as FILE:/path"),
            std::string::npos)
      << failure_of(path);
  const auto file = open_volume(path + ":/g/h/c");
  EXPECT_EQ(file->header().path, path + ":/g/h/c");
  EXPECT_EQ(read_all(*file), "g");
  EXPECT_EQ(failure_of(path + ":/soft/c"), "");
}

TEST(UnitHdf5, ADatasetUnderTwoNamesIsOneAndThreeAxesGoBeforeFourAndTwo) {
  const TemporaryFolder folder;
  {
    Hdf5Fixture file(folder / "a.h5");
    file.dataset("table", {5, 2}, counting<float>(10));
    file.dataset("series", {1, 2, 2, 2}, counting<float>(8));
    file.dataset("volume", {1, 1, 3}, counting<float>(3));
    H5Lcreate_hard(file.get(), "/volume", file.get(), "/again", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_hard(file.get(), "/", file.get(), "/cycle", H5P_DEFAULT, H5P_DEFAULT);
  }
  EXPECT_EQ(open_volume(folder / "a.h5")->header().geometry.dims(), Vec3i(3, 1, 1));
}

TEST(UnitHdf5, OnlyAFileBeforeTheColonIsSplitOff) {
  const TemporaryFolder folder;
  const std::string file = folder.write("a.h5", "x");
  EXPECT_EQ(file_part(file + ":/g/v"), file);
  EXPECT_EQ(file_part(file + ":/g:/v"), file + ":/g:/v");
  EXPECT_EQ(file_part(folder / "none.h5:/v"), folder / "none.h5:/v");
  EXPECT_EQ(file_part(file), file);
  std::filesystem::create_directory(folder / "odd:");
  const std::string inside = folder.write("odd:/v.h5", "x");
  folder.write("odd", "x");
  EXPECT_EQ(file_part(inside), inside);
}

}  // namespace
}  // namespace supple::test
