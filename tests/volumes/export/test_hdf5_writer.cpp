// HDF5 files as written, read back by the HDF5 library itself and by h5py.
#include <cstdlib>
#include <cstring>

#include <gtest/gtest.h>
#include <hdf5.h>

#include "tests/support/errors.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "volumes/base/error.h"
#include "volumes/io/format/dense_writer.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"
#include "volumes/io/volume_writer.h"
#include "volumes/io/warp_file.h"

using namespace supple;
using namespace supple::test;

namespace {

const Vec3i kDims(4, 3, 2);
const Geometry kSmall(kDims, {1.5, -2, 0.1}, {Vec3d(0, 0.5, 0), {-2, 0, 0}, {0, 0, 3}});
constexpr int kSlice = 12;

void small_slices(int k, float* out) {
  for (int n = 0; n < kSlice; ++n) out[n] = float(kSlice * k + n);
}

void small_vectors(int k, Vec3f* out) {
  for (int n = 0; n < kSlice; ++n) out[n] = Vec3f(float(k), float(n), -0.1f);
}

WriteOptions compressed(bool compress) {
  WriteOptions options;
  options.compress = compress;
  return options;
}

/// All numbers of a dataset, with its dims.
struct Numbers {
  std::vector<hsize_t> dims;
  std::vector<double> values;
};
Numbers numbers_of(const std::string& path, const char* name, hid_t* stored_type = nullptr) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t set = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(set);
  Numbers numbers;
  numbers.dims.resize(std::size_t(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, numbers.dims.data(), nullptr);
  numbers.values.resize(std::size_t(H5Sget_simple_extent_npoints(space)));
  H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.values.data());
  if (stored_type != nullptr) *stored_type = H5Dget_type(set);
  H5Sclose(space);
  H5Dclose(set);
  H5Fclose(file);
  return numbers;
}

std::string text_of(const std::string& path, const char* name) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t set = H5Dopen2(file, name, H5P_DEFAULT), type = H5Dget_type(set);
  std::string text;
  char* characters = nullptr;
  if (H5Tis_variable_str(type) > 0 &&
      H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &characters) >= 0) {
    text = characters;
  }
  H5free_memory(characters);
  H5Tclose(type);
  H5Dclose(set);
  H5Fclose(file);
  return text;
}

bool has(const std::string& path, const char* name) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const bool exists = H5Lexists(file, name, H5P_DEFAULT) > 0;
  H5Fclose(file);
  return exists;
}

}  // namespace

TEST(UnitHdf5Writer, AVolumeIsAnItkImageWithAxesAsRows) {
  const TemporaryFolder folder;
  for (const bool compress : {false, true}) {
    const std::string path = folder / "a.h5";
    write_volume(path, kSmall, ValueType::int16, small_slices, nullptr, compressed(compress));
    hid_t type = H5I_INVALID_HID;
    const Numbers voxels = numbers_of(path, "/ITKImage/0/VoxelData", &type);
    EXPECT_EQ(voxels.dims, (std::vector<hsize_t>{2, 3, 4}));
    for (int n = 0; n < 24; ++n) EXPECT_EQ(voxels.values[std::size_t(n)], n);
    EXPECT_GT(H5Tequal(type, H5T_STD_I16LE), 0);
    H5Tclose(type);
    EXPECT_EQ(numbers_of(path, "/ITKImage/0/Dimension").values, (std::vector<double>{4, 3, 2}));
    EXPECT_EQ(numbers_of(path, "/ITKImage/0/Origin").values, (std::vector<double>{1.5, -2, 0.1}));
    EXPECT_EQ(numbers_of(path, "/ITKImage/0/Spacing").values, (std::vector<double>{0.5, 2, 3}));
    const Numbers directions = numbers_of(path, "/ITKImage/0/Directions");
    EXPECT_EQ(directions.dims, (std::vector<hsize_t>{3, 3}));
    EXPECT_EQ(directions.values, (std::vector<double>{0, 1, 0, -1, 0, 0, 0, 0, 1}));
    EXPECT_EQ(text_of(path, "/ITKImage/0/VoxelType"), "SHORT");
    EXPECT_TRUE(has(path, "/ITKImage/0/MetaData"));
  }
}

TEST(UnitHdf5Writer, AWarpIsAnItkTransformOfDoubles) {
  const TemporaryFolder folder;
  for (const bool compress : {false, true}) {
    const std::string path = folder / "a.hdf5";
    write_warp(path, {kSmall, WarpDirection::material, "{\"cells\":3}"}, small_vectors, nullptr,
               compressed(compress));
    EXPECT_EQ(text_of(path, "/TransformGroup/0/TransformType"),
              "DisplacementFieldTransform_double_3_3");
    EXPECT_EQ(numbers_of(path, "/TransformGroup/0/TransformFixedParameters").values,
              (std::vector<double>{4, 3, 2, 1.5, -2, 0.1, 0.5, 2, 3, 0, -1, 0, 1, 0, 0, 0, 0, 1}));
    hid_t type = H5I_INVALID_HID;
    const Numbers vectors = numbers_of(path, "/TransformGroup/0/TransformParameters", &type);
    EXPECT_GT(H5Tequal(type, H5T_IEEE_F64LE), 0);
    H5Tclose(type);
    ASSERT_EQ(vectors.dims, std::vector<hsize_t>{72});
    for (int n = 0; n < 24; ++n) {
      EXPECT_EQ(vectors.values[std::size_t(3 * n)], n / kSlice);
      EXPECT_EQ(vectors.values[std::size_t(3 * n) + 1], n % kSlice);
      EXPECT_EQ(vectors.values[std::size_t(3 * n) + 2], double(-0.1f));
    }
  }
}

TEST(PropertyHdf5Writer, DirectionAndCertificateAreReadBack) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.h5",
                    certificate = "{\"text\":\"" + std::string(5000, 'c') + "\"}";
  for (const WarpDirection direction : {WarpDirection::resample, WarpDirection::material}) {
    write_warp(path, {kSmall, direction, certificate}, small_vectors);
    const Warp warp = read_warp(path);
    EXPECT_EQ(warp.direction, direction);
    EXPECT_TRUE(warp.geometry == kSmall);
    EXPECT_EQ(warp.vectors[13], Vec3f(1, 1, -0.1f));
    EXPECT_EQ(open_volume(path,
                          [] {
                            ReadOptions options;
                            options.channel = 0;
                            return options;
                          }())
                  ->header()
                  .certificate,
              certificate);
  }
}

TEST(PropertyHdf5Writer, EqualInputsGiveEqualBytesAndCompressionTheSameValues) {
  const TemporaryFolder folder;
  for (const bool compress : {false, true}) {
    write_volume(folder / "a.h5", kSmall, ValueType::float32, small_slices, nullptr,
                 compressed(compress));
    write_warp(folder / "b.h5", {kSmall, WarpDirection::resample}, small_vectors, nullptr,
               compressed(compress));
    const std::string volume = read_text(folder / "a.h5"), warp = read_text(folder / "b.h5");
    ::sleep(1);  // HDF5 notes times in seconds where it is let
    write_volume(folder / "a.h5", kSmall, ValueType::float32, small_slices, nullptr,
                 compressed(compress));
    write_warp(folder / "b.h5", {kSmall, WarpDirection::resample}, small_vectors, nullptr,
               compressed(compress));
    EXPECT_EQ(read_text(folder / "a.h5"), volume);
    EXPECT_EQ(read_text(folder / "b.h5"), warp);
  }
  const Geometry large({64, 64, 8}, {0, 0, 0}, kSmall.axes_mm());
  const auto flat = [](int, float* out) { std::fill_n(out, 64 * 64, 2.0f); };
  write_volume(folder / "c.h5", large, ValueType::float32, flat, nullptr, compressed(true));
  EXPECT_LT(std::filesystem::file_size(folder / "c.h5"), 20000u);
  EXPECT_EQ(load_volume(folder / "c.h5").geometry.dims(), large.dims());
}

TEST(FaultHdf5Writer, ShearedAxesAreRefused) {
  const TemporaryFolder folder;
  const Geometry sheared(kDims, {0, 0, 0}, {Vec3d(1, 0, 0), {0.2, 1, 0}, {0, 0, 1}});
  const std::string error = error_of([&] {
    write_warp(folder / "a.h5", {sheared, WarpDirection::resample}, small_vectors);
  });
  EXPECT_NE(error.find("geometry: found sheared axes"), std::string::npos) << error;
  EXPECT_EQ(folder.entries().size(), 0u);
}

TEST(FaultHdf5Writer, AFullDiskKeepsTheOldFileAndLeavesNothingElse) {
  const TemporaryFolder folder;
  const Geometry large({200, 100, 3}, {0, 0, 0}, kSmall.axes_mm());
  const auto slices = [](int k, Vec3f* out) { std::fill_n(out, 20000, Vec3f(float(k), 1, 2)); };
  write_warp(folder / "a.h5", {kSmall, WarpDirection::resample}, small_vectors);
  const std::string old = read_text(folder / "a.h5");
  for (const rlim_t limit : {0, 40, 3000, 100000, 500000, 1439999}) {
    std::string error;
    {
      const FileSizeLimit full(limit);
      error = error_of([&] {
        write_warp(folder / "a.h5", {large, WarpDirection::resample}, slices);
      });
    }
    EXPECT_NE(error.find("a.h5: cannot write: File too large"), std::string::npos) << error;
    EXPECT_EQ(read_text(folder / "a.h5"), old);
    EXPECT_EQ(folder.entries().size(), 1u);
  }
  write_warp(folder / "a.h5", {large, WarpDirection::resample}, slices);
  EXPECT_EQ(read_warp(folder / "a.h5").vectors[20000], Vec3f(1, 1, 2));
}

TEST(InteropHdf5, H5pyReadsOurVolumesAndWarps) {
  if (!runs_python("-c 'import h5py' 2>&1")) GTEST_SKIP() << "python3-h5py is not installed";
  const TemporaryFolder folder;
  write_volume(folder / "v.h5", kSmall, ValueType::uint16, small_slices, nullptr, compressed(true));
  write_warp(folder / "w.h5", {kSmall, WarpDirection::resample}, small_vectors);
  write_text(folder / "check.py", R"(
import sys, h5py, numpy as np
v = h5py.File(sys.argv[1], 'r')['ITKImage/0']
assert (v['VoxelData'][()] == np.arange(24, dtype='<u2').reshape(2, 3, 4)).all()
assert v['VoxelData'].dtype == '<u2' and v['VoxelType'][0] == b'USHORT'
w = h5py.File(sys.argv[2], 'r')['TransformGroup/0']
assert w['TransformType'][0] == b'DisplacementFieldTransform_double_3_3'
fixed = w['TransformFixedParameters'][()]
field = w['TransformParameters'][()].reshape(*fixed[2::-1].astype(int), 3)
assert tuple(field[1, 2, 3]) == (1, 11, np.float32(-0.1))
# The world position of voxel (3, 2, 1) as ITK computes it: direction (spacing * index) + origin.
world = fixed[9:].reshape(3, 3) @ (fixed[6:9] * [3, 2, 1]) + fixed[3:6]
assert np.allclose(world, [1.5 - 4, -2 + 1.5, 0.1 + 3]), world
assert w.attrs['supple_direction'] == b'resample'
)");
  EXPECT_TRUE(runs_python(folder / "check.py" + (" " + folder / "v.h5") + (" " + folder / "w.h5")));
}

TEST(InteropHdf5, WhatH5pyWritesIsRead) {
  if (!runs_python("-c 'import h5py' 2>&1")) GTEST_SKIP() << "python3-h5py is not installed";
  const TemporaryFolder folder;
  write_text(folder / "make.py", R"(
import sys, h5py, numpy as np
a = np.arange(24).reshape(2, 3, 4)
with h5py.File(sys.argv[1], 'w', libver='latest') as f:
    d = f.create_dataset('t0/channel', data=a.astype('>f8'), chunks=True, compression='gzip',
                         shuffle=True, fletcher32=True, maxshape=(None, None, None))
    d.attrs['element_size_um'] = np.array([3000, 2000, 500], 'f4')
    f['mask'] = a > 11
    f.create_dataset('lossless', data=a.astype('i4'), scaleoffset=0)
    d = f.create_dataset('units', data=a.astype('u1'))
    d.attrs['resolution'] = (3, 2, 0.5)
    d.attrs['units'] = 'µm'
)");
  const std::string path = folder / "a.h5";
  ASSERT_TRUE(runs_python(folder / "make.py" + (" " + path)));
  const auto first = open_volume(path + ":/t0/channel");
  EXPECT_EQ(first->header().type, ValueType::float64);
  EXPECT_LT((first->header().geometry.spacing_mm() - Vec3d(0.5, 2, 3)).length(), 1e-6);
  std::vector<double> slice(kSlice);
  for (int k = 0; k < 2; ++k) {
    first->read_slice(slice.data());
    for (int n = 0; n < kSlice; ++n) EXPECT_EQ(slice[std::size_t(n)], kSlice * k + n);
  }
  EXPECT_EQ(load_volume(path + ":/mask").statistics.mean, 0.5);
  EXPECT_EQ(load_volume(path + ":/lossless").statistics.mean, 11.5);
  EXPECT_LT(
      (open_volume(path + ":/units")->header().geometry.spacing_mm() - Vec3d(5e-4, 2e-3, 3e-3))
          .length(),
      1e-12);
}
