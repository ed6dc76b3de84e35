// Damaged and hostile HDF5 files: one line, nothing outside the file, no memory for a claim.
#include <random>

#include <gtest/gtest.h>
#include <sys/stat.h>
#ifdef SUPPLE_SANITIZED_ADDRESS
#include <sanitizer/lsan_interface.h>
#endif

#include "tests/support/io_fixtures.h"
#include "tests/support/sanitized.h"
#include "tests/support/temporary_folder.h"
#include "tests/volumes/io/hdf5_fixtures.h"
#include "volumes/base/error.h"

namespace supple::test {
namespace {

void expect_line(const std::string& path, const std::vector<std::string>& parts) {
  const std::string line = failure_of(path);
  EXPECT_NE(line, "") << path << " was read";
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  EXPECT_LT(line.size(), 400u) << line;
  for (const std::string& part : parts) {
    EXPECT_NE(line.find(part), std::string::npos) << "\"" << part << "\" in: " << line;
  }
}

/// An ITK image with text, attributes and compressed chunks: every structure that we read.
std::string sound_bytes(const TemporaryFolder& folder) {
  {
    Hdf5Fixture file(folder / "sound.h5");
    const std::string group = "/ITKImage/0/";
    Hdf5Storage storage{H5T_STD_I16BE, {2, 3, 4}};
    storage.deflate = storage.fletcher = true;
    file.dataset(group + "VoxelData", {4, 6, 8}, counting<std::int16_t>(192), storage);
    file.dataset(group + "Dimension", {3}, std::vector<std::uint64_t>{8, 6, 4});
    file.numbers(group + "Origin", {1, 2, 3});
    file.numbers(group + "Spacing", {1, 2, 3});
    file.dataset(group + "Directions", {3, 3}, std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1});
    file.text(group + "VoxelType", "SHORT");
    file.attribute(group + "VoxelData", "element_size_um", {1, 2, 3});
  }
  return read_text(folder / "sound.h5");
}

TEST(FaultHdf5, WhatIsNoFileOfTheFormatIsNamed) {
  const TemporaryFolder folder;
  expect_line(folder / "none.h5:/v", {"none.h5:/v", "no such file"});
  expect_line(folder.write("text.h5", "not that"), {"text.h5: HDF5: found", "intact HDF5 file"});
  expect_line(folder.write("table.csv", "1,2") + ":/v", {"table.csv:/v: HDF5: found"});
  expect_line(folder.write("empty.h5", "") + ":/v", {"found 0 bytes"});
  ASSERT_EQ(::mkfifo((folder / "pipe.h5").c_str(), 0600), 0);
  expect_line(folder / "pipe.h5:/v", {"pipe"});
}

TEST(FaultHdf5, DamageOnWhichTheLibraryCrashes) {
  const TemporaryFolder folder;
  std::string bytes = sound_bytes(folder);
  // The message of the root group's symbol table, two addresses: its names lie nowhere.
  const std::size_t table = bytes.find(std::string("\x11\0\x10\0", 4));
  ASSERT_NE(table, std::string::npos);
  for (std::size_t byte = 8; byte < 24; ++byte) bytes[table + byte] = '\xff';
  expect_line(folder.write("nowhere.h5", bytes), {"nowhere.h5", "an intact HDF5 file"});
}

TEST(FaultHdf5, LinksVirtualDatasetsAndExternalFilesAreNotFollowed) {
  const TemporaryFolder folder;
  Hdf5Fixture(folder / "other.h5").dataset("v", {1, 2, 2}, counting<float>(4));
  folder.write("values.raw", std::string(16, 'x'));
  const hsize_t dims[] = {1, 2, 2};
  const hid_t space = H5Screate_simple(3, dims, nullptr);
  {
    Hdf5Fixture file(folder / "a.h5");
    H5Lcreate_external("other.h5", "/v", file.get(), "/link", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_external("other.h5", "/", file.get(), "/folder", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_soft("/folder/v", file.get(), "/soft", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_soft("/nowhere", file.get(), "/dangling", H5P_DEFAULT, H5P_DEFAULT);
    const hid_t outside = H5Pcreate(H5P_DATASET_CREATE), other = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(outside, (folder / "values.raw").c_str(), 0, 16);
    H5Pset_virtual(other, space, "other.h5", "/v", space);
    H5Dclose(
        H5Dcreate2(file.get(), "/raw", H5T_IEEE_F32LE, space, H5P_DEFAULT, outside, H5P_DEFAULT));
    H5Dclose(
        H5Dcreate2(file.get(), "/virtual", H5T_IEEE_F32LE, space, H5P_DEFAULT, other, H5P_DEFAULT));
    H5Pclose(outside);
    H5Pclose(other);
  }
  H5Sclose(space);
  const std::string path = folder / "a.h5";
  expect_line(path + ":/link", {"a link into the file other.h5", "a dataset inside the file"});
  expect_line(path + ":/folder/v", {"a link into the file other.h5"});
  expect_line(path + ":/soft", {"a link into the file other.h5"});
  expect_line(path + ":/dangling", {"/dangling: found nothing"});
  expect_line(path + ":/raw", {"values in an external file"});
  expect_line(path + ":/virtual", {"a virtual dataset"});
}

/// Registers as a filter of a plugin would, so that a file with it can be written.
size_t copying_filter(unsigned, size_t, const unsigned*, size_t bytes, size_t*, void**) {
  return bytes;
}

TEST(FaultHdf5, FiltersThatAreNotBuiltInAreNamed) {
  const TemporaryFolder folder;
  H5Z_class2_t filter{H5Z_CLASS_T_VERS, 32015, 1, 1, "zstd", nullptr, nullptr, copying_filter};
  ASSERT_GE(H5Zregister(&filter), 0);
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  const hsize_t dims[] = {2, 2, 2};
  H5Pset_chunk(creation, 3, dims);
  H5Pset_filter(creation, 32015, H5Z_FLAG_MANDATORY, 0, nullptr);
  const hid_t space = H5Screate_simple(3, dims, nullptr);
  {
    Hdf5Fixture file(folder / "a.h5");
    const hid_t set =
        H5Dcreate2(file.get(), "v", H5T_STD_U8LE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    const auto values = counting<std::uint8_t>(8);
    H5Dwrite(set, H5T_STD_U8LE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(set);
  }
  H5Sclose(space);
  H5Pclose(creation);
  // Refused although the library could decode it now, and when it cannot.
  expect_line(folder / "a.h5", {"/v: found filter 32015 zstd", "gzip, shuffle", "h5repack"});
  H5Zunregister(32015);
  expect_line(folder / "a.h5", {"/v: found filter 32015 zstd", "gzip, shuffle", "h5repack"});
}

TEST(FaultHdf5, ValuesThatAreNoNumbersAreNamedByTheirClass) {
  const TemporaryFolder folder;
  const hid_t pair = H5Tcreate(H5T_COMPOUND, 8), row = H5Tvlen_create(H5T_STD_I32LE);
  H5Tinsert(pair, "a", 0, H5T_STD_I32LE);
  H5Tinsert(pair, "b", 4, H5T_STD_I32LE);
  const hsize_t three = 3;
  const hid_t array = H5Tarray_create2(H5T_IEEE_F32LE, 1, &three), text = H5Tcopy(H5T_C_S1);
  const hid_t opaque = H5Tcreate(H5T_OPAQUE, 4), odd = H5Tcopy(H5T_STD_I32LE);
  H5Tset_size(odd, 3);
  const std::vector<std::pair<const char*, hid_t>> types = {
      {"compound values", pair},     {"values of variable length", row},
      {"arrays as values", array},   {"strings", text},
      {"opaque bytes", opaque},      {"references", H5T_STD_REF_OBJ},
      {"bit fields", H5T_STD_B16LE}, {"integers of an unusual size", odd}};
  const hsize_t dims[] = {2, 2, 2};
  const hid_t space = H5Screate_simple(3, dims, nullptr);
  {
    Hdf5Fixture file(folder / "a.h5");
    for (std::size_t n = 0; n < types.size(); ++n) {
      const std::string name = "/v" + std::to_string(n);
      H5Dclose(H5Dcreate2(file.get(), name.c_str(), types[n].second, space, H5P_DEFAULT,
                          H5P_DEFAULT, H5P_DEFAULT));
    }
    file.group("/group");
    file.dataset("/line", {4}, counting<float>(4));
    file.dataset("/five", {1, 1, 1, 1, 2}, counting<float>(2));
  }
  H5Sclose(space);
  const std::string path = folder / "a.h5";
  for (std::size_t n = 0; n < types.size(); ++n) {
    expect_line(path + ":/v" + std::to_string(n), {std::string("found ") + types[n].first});
  }
  for (const hid_t type : {pair, row, array, text, opaque, odd}) H5Tclose(type);
  expect_line(path + ":/group", {"/group: found a group"});
  expect_line(path + ":/line", {"found 1 axes"});
  expect_line(path + ":/five", {"found 5 axes"});
  expect_line(path + ":/none", {"/none: found nothing"});
}

TEST(FaultHdf5, ClaimsBeyondWhatIsStoredAreRefusedBeforeAllocation) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.h5";
  {
    Hdf5Fixture file(path);
    const Hdf5Storage chunked{H5T_IEEE_F32LE, {16, 16, 16}};
    const std::vector<float> none;
    file.dataset("a", {100000, 100000, 100000}, none, chunked);
    file.dataset("b", {8000, 8000, 8000}, none, chunked);
    file.dataset("c", {1, 30000, 30000}, none, {H5T_IEEE_F32LE, {1, 16, 16}});
    file.dataset("d", {600, 1000, 1000}, none, {H5T_IEEE_F32LE, {600, 1000, 1000}});
    file.dataset("e", {3000000000, 1, 1}, none, {H5T_IEEE_F32LE, {16, 1, 1}});
    file.dataset("/ITKImage/0/VoxelData", {1, 1, 1}, none);
    file.dataset("/ITKImage/0/Dimension", {1u << 30}, none, {H5T_IEEE_F32LE, {16}});
    for (const char* name : {"Directions", "Origin", "Spacing"}) {
      file.numbers(std::string("/ITKImage/0/") + name, {1});
    }
  }
  expect_line(path + ":/a", {"2^40"});
  expect_line(path + ":/b", {"2.048e+12 bytes of values in 0 bytes"});
  expect_line(path + ":/c", {"slices of 3.6e+09 bytes", "at most 2 GiB"});
  expect_line(path + ":/d", {"chunks of 2.4e+09 bytes", "at most 2 GiB"});
  expect_line(path + ":/e", {"2147483647"});
  expect_line(path, {"Dimension: found 1073741824 numbers"});
}

TEST(FaultHdf5, ATruncatedFileIsAnErrorWhereverItEnds) {
  const TemporaryFolder folder;
  const std::string bytes = sound_bytes(folder);
  ASSERT_EQ(failure_of(folder / "sound.h5"), "");
  for (int tenth = 0; tenth < 10; ++tenth) {
    const std::string part = bytes.substr(0, bytes.size() * std::size_t(tenth) / 10);
    expect_line(folder.write("a.h5", part), {"a.h5"});
  }
  expect_line(folder.write("a.h5", bytes.substr(0, bytes.size() - 1)), {"truncated file"});
}

TEST(FaultHdf5, FlippedBytesGiveALineOrAVolumeButNothingElse) {
#ifdef SUPPLE_SANITIZED_ADDRESS
  // The library (1.10.8) itself loses a few kB where object headers are damaged, some of it from
  // blocks that it keeps for use again.
  H5garbage_collect();
  const __lsan::ScopedDisabler unchecked;
#endif
  const TemporaryFolder folder;
  const std::string bytes = sound_bytes(folder);
  std::mt19937 random(7);
  int refused = 0;
  for (int n = 0; n < cases(600); ++n) {
    std::string damaged = bytes;
    for (unsigned long flips = 1 + random() % 3; flips > 0; --flips) {
      // Half of the flips go into the superblock and the first headers.
      const std::size_t at = random() % (flips % 2 == 1 ? 800 : bytes.size());
      damaged[at] = char(random());
    }
    const std::string line = failure_of(folder.write("a.h5", damaged));
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    refused += !line.empty();
  }
  EXPECT_GT(refused, cases(100));
}

}  // namespace
}  // namespace supple::test
