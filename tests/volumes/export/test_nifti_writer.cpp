// Bytes of our NIfTI files, and that our reader gives back what was written.
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/errors.h"
#include "tests/support/random_state.h"
#include "tests/support/temporary_folder.h"
#include "volumes/base/error.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/volume_writer.h"
#include "volumes/io/warp_file.h"

using namespace supple;
using namespace supple::test;

namespace {

/// i to the patient's anterior, j to the left, k up: RAS rows (0, 2, 0), (-0.5, 0, 0), (0, 0, 3).
const Geometry kTurned({3, 2, 2}, {1.5, -2, 0.25}, {Vec3d(0, -0.5, 0), {2, 0, 0}, {0, 0, 3}});

Vec3f counting_vector(int k, int n) {
  return Vec3f(float(100 * k + n), float(n) - 0.5f, -float(k) - 0.25f);
}

void turned_vectors(int k, Vec3f* out) {
  for (int n = 0; n < 6; ++n) out[n] = counting_vector(k, n);
}

template <class T>
T value_at(const std::string& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

template <class T>
std::vector<T> values_at(const std::string& bytes, std::size_t offset, std::size_t count) {
  std::vector<T> values(count);
  std::memcpy(values.data(), bytes.data() + offset, count * sizeof(T));
  return values;
}

/// Axes at right angles and of any length, in any handedness.
Geometry random_perpendicular(std::mt19937& random, const Vec3i& dims) {
  const Geometry base = random_geometry(random, dims);
  const auto unit = base.direction();
  const Vec3d second = unit[0].cross(unit[1]).normalized();
  const double sign = random() % 2 == 0 ? 1 : -1;
  return Geometry(dims, base.origin_lps_mm(),
                  {unit[0] * 0.7, second * 1.9, unit[0].cross(second) * (sign * 3.1)});
}

/// The bound of nifti_header.h on what 32-bit floats move.
void expect_within_float_rounding(const Geometry& found, const Geometry& written) {
  EXPECT_EQ(found.dims(), written.dims());
  const Vec3d last = Vec3d(written.dims()) - Vec3d(1);
  for (int a = 0; a < 3; ++a) {
    double extent = std::abs(written.origin_lps_mm()[a]);
    for (int c = 0; c < 3; ++c) extent += std::abs(written.axes_mm()[c][a]) * last[c];
    const double moved = found.world_from_index(last)[a] - written.world_from_index(last)[a];
    EXPECT_LE(std::abs(moved), std::ldexp(extent, -24) + 1e-12);
  }
}

}  // namespace

TEST(UnitNiftiWriter, AWarpHasTheFieldsAndTheLayoutOfTheDesign) {
  const TemporaryFolder folder;
  write_warp(folder / "a.nii", {kTurned, WarpDirection::material, "{\"n\":1}"}, turned_vectors);
  const std::string bytes = read_text(folder / "a.nii");
  EXPECT_EQ(value_at<std::int32_t>(bytes, 0), 348);
  EXPECT_EQ(values_at<std::int16_t>(bytes, 40, 8),
            (std::vector<std::int16_t>{5, 3, 2, 2, 1, 3, 1, 1}));
  EXPECT_EQ(value_at<std::int16_t>(bytes, 68), 1007);
  EXPECT_EQ(values_at<std::int16_t>(bytes, 70, 2), (std::vector<std::int16_t>{16, 32}));
  EXPECT_EQ(values_at<float>(bytes, 76, 4), (std::vector<float>{1, 0.5f, 2, 3}));
  EXPECT_EQ(bytes[123], 2);
  EXPECT_EQ(values_at<std::int16_t>(bytes, 252, 2), (std::vector<std::int16_t>{1, 1}));
  const float half = float(std::sqrt(0.5));  // a quarter turn about z
  EXPECT_EQ(values_at<float>(bytes, 256, 6), (std::vector<float>{0, 0, half, -1.5f, 2, 0.25f}));
  EXPECT_EQ(values_at<float>(bytes, 280, 12),
            (std::vector<float>{0, -2, 0, -1.5f, 0.5f, 0, 0, 2, 0, 0, 3, 0.25f}));
  EXPECT_EQ(bytes.substr(344, 4), std::string("n+1\0", 4));

  const std::string text = "supple direction: material\nsupple certificate: {\"n\":1}\n";
  EXPECT_EQ(bytes.substr(348, 4), std::string("\1\0\0\0", 4));
  EXPECT_EQ(values_at<std::int32_t>(bytes, 352, 2), (std::vector<std::int32_t>{64, 6}));
  EXPECT_EQ(bytes.substr(360, text.size()), text);
  ASSERT_EQ(value_at<float>(bytes, 108), 416);

  ASSERT_EQ(bytes.size(), 416u + 36 * sizeof(float));
  const auto values = values_at<float>(bytes, 416, 36);
  for (int n = 0; n < 12; ++n) {
    const Vec3f vector = counting_vector(n / 6, n % 6);
    EXPECT_EQ(Vec3f(values[n], values[12 + n], values[24 + n]), vector);
  }
}

TEST(UnitNiftiWriter, RasVectorsHaveTheirIntentAndXAndYTurned) {
  const TemporaryFolder folder;
  WriteOptions options;
  options.ras_vectors = true;
  write_warp(folder / "a.nii", {kTurned}, turned_vectors, nullptr, options);
  const std::string bytes = read_text(folder / "a.nii");
  EXPECT_EQ(value_at<std::int16_t>(bytes, 68), 1006);
  const auto values = values_at<float>(bytes, bytes.size() - 144, 36);
  EXPECT_EQ(Vec3f(values[7], values[19], values[31]), Vec3f(-101, -0.5f, -1.25f));
  EXPECT_EQ(read_warp(folder / "a.nii").vectors[7], counting_vector(1, 1));
  EXPECT_NE(error_of([&] {
              write_volume(
                  folder / "b.nii", kTurned, ValueType::uint8,
                  [](int, float* out) { std::fill_n(out, 6, 1.0f); }, nullptr, options);
            }).find("intent: found a scalar volume"),
            std::string::npos);
}

TEST(PropertyNiftiWriter, WarpsComeBackExactlyWithGridDirectionAndCertificate) {
  const TemporaryFolder folder;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> value(-30, 30);
  for (int n = 0; n < 40; ++n) {
    const Vec3i dims(1 + int(random() % 9), 1 + int(random() % 9), 1 + int(random() % 9));
    const Geometry geometry = random_perpendicular(random, dims);
    std::vector<Vec3f> vectors(std::size_t(geometry.voxel_count()));
    for (Vec3f& v : vectors) v = Vec3f(value(random), value(random), value(random));
    const std::string path = folder / (n % 2 == 0 ? "a.nii" : "a.nii.gz");
    WriteOptions options;
    options.ras_vectors = n % 4 >= 2;
    const std::size_t slice = std::size_t(dims.x) * std::size_t(dims.y);
    const auto slices = [&](int k, Vec3f* out) {
      std::copy_n(&vectors[slice * std::size_t(k)], slice, out);
    };
    const WarpFacts facts{geometry, WarpDirection::material, "{\"folded\": 3}"};
    EXPECT_TRUE(write_warp(path, facts, slices, nullptr, options).empty());  // qform too

    const Warp warp = read_warp(path);
    EXPECT_EQ(warp.vectors, vectors);
    EXPECT_EQ(warp.direction, WarpDirection::material);
    expect_within_float_rounding(warp.geometry, geometry);
    const auto file = open_scalars_or_vectors(path);
    EXPECT_EQ(file->header().certificate, "{\"folded\": 3}");
    EXPECT_TRUE(file->header().warnings.empty());
  }
  EXPECT_EQ(folder.entries().size(), 2u);
}

TEST(PropertyNiftiWriter, VolumesOfEveryTypeComeBackWithTheirScaling) {
  const TemporaryFolder folder;
  std::mt19937 random(6);
  for (int n = 0; n < 40; ++n) {
    const Vec3i dims(1 + int(random() % 9), 1 + int(random() % 9), 1 + int(random() % 9));
    DenseImage image;
    image.geometry = random_geometry(random, dims);  // sheared
    image.type = ValueType(n % 10);
    image.slope = 0.5 * (1 + n % 3);
    image.intercept = -1024;
    const std::size_t slice = std::size_t(dims.x) * dims.y * bytes_of(image.type);
    std::string bytes(slice * std::size_t(dims.z), '\0');
    for (char& byte : bytes) byte = char(random());
    const std::string path = folder / (n % 4 < 2 ? "a.nii" : "a.nii.gz");
    ASSERT_TRUE(keeps_scaling(path));
    const auto writer = create_dense(path, image);
    for (int k = 0; k < dims.z; ++k) writer->write_slice(bytes.data() + slice * std::size_t(k));
    writer->commit();
    EXPECT_EQ(writer->warnings(),
              (std::vector<std::string>{"the axes are in the sform alone, since no qform holds "
                                        "them"}));

    const auto file = open_volume(path);
    EXPECT_EQ(file->header().type, image.type);
    EXPECT_EQ(file->header().slope, image.slope);
    EXPECT_EQ(file->header().intercept, -1024);
    EXPECT_TRUE(file->header().warnings.empty());
    expect_within_float_rounding(file->header().geometry, image.geometry);
    std::string found(bytes.size(), '\0');
    for (int k = 0; k < dims.z; ++k) file->read_slice(found.data() + slice * std::size_t(k));
    EXPECT_EQ(found, bytes);
  }
}

TEST(UnitNiftiWriter, ADimensionOrASlopeBeyondVersionOneTakesVersionTwo) {
  const TemporaryFolder folder;
  const auto written = [&](int length, double slope) {
    DenseImage image;
    image.geometry = kTurned.with_dims({length, 1, 1});
    image.type = ValueType::uint8;
    image.slope = slope;
    const auto writer = create_dense(folder / "a.nii", image);
    const std::string row(std::size_t(length), 'x');
    writer->write_slice(row.data());
    writer->commit();
    const auto file = open_volume(folder / "a.nii");
    EXPECT_EQ(file->header().geometry.dims(), Vec3i(length, 1, 1));
    EXPECT_NEAR(file->header().slope, slope, slope * 1e-7);
    std::string found(row.size(), '\0');
    file->read_slice(found.data());
    EXPECT_EQ(found, row);
    return std::pair(value_at<std::int32_t>(read_text(folder / "a.nii"), 0), writer->warnings());
  };
  const std::string rounded = "slope and intercept are rounded to the 32-bit floats of NIfTI-1";
  EXPECT_EQ(written(32767, 2), std::pair(348, std::vector<std::string>{}));
  EXPECT_EQ(written(32767, 0.1), std::pair(348, std::vector<std::string>{rounded}));
  EXPECT_EQ(written(32768, 0.1), std::pair(540, std::vector<std::string>{}));
  EXPECT_EQ(written(2, 1e-50), std::pair(540, std::vector<std::string>{}));
}

TEST(UnitNiftiWriter, AQformThatFloatsCannotHoldIsLeftUnset) {
  // Nearly half a turn: the quaternion's first component is the root of what rounding leaves.
  const TemporaryFolder folder;
  for (const auto& [angle, code] : {std::pair(0.0, 1), {5e-4, 0}, {0.3, 1}}) {
    const double c = std::cos(angle), s = std::sin(angle);
    DenseImage image;
    image.geometry = Geometry({2000, 2, 2}, {0, 0, 0}, {Vec3d(c, s, 0), {-s, c, 0}, {0, 0, 1}});
    image.type = ValueType::uint8;
    const auto writer = create_dense(folder / "a.nii", image);
    const std::string slice(4000, 'x');
    writer->write_slice(slice.data());
    writer->write_slice(slice.data());
    writer->commit();
    EXPECT_EQ(value_at<std::int16_t>(read_text(folder / "a.nii"), 252), code) << angle;
    const auto file = open_volume(folder / "a.nii");
    EXPECT_TRUE(file->header().warnings.empty());
    expect_within_float_rounding(file->header().geometry, image.geometry);
  }
}

TEST(FaultNiftiWriter, AShearedWarpIsRefused) {
  const TemporaryFolder folder;
  const Geometry sheared({3, 2, 2}, {0, 0, 0}, {Vec3d(1, 0, 0), {0.2, 1, 0}, {0, 0, 1}});
  const std::string error =
      error_of([&] { write_warp(folder / "a.nii.gz", {sheared}, turned_vectors); });
  EXPECT_NE(error.find("geometry: found sheared axes"), std::string::npos) << error;
  EXPECT_EQ(folder.entries().size(), 0u);
}

TEST(FaultNiftiWriter, AFullDiskOrACancelLeavesTheOldFileAndNothingElse) {
  struct Stop : Progress {
    void stage(std::string_view) override {}
    void update(double) override { ++slices; }
    bool cancelled() const override { return slices == at; }
    int slices = 0, at = 1;
  };
  const TemporaryFolder folder;
  const Geometry large({100, 100, 3}, {0, 0, 0}, kTurned.axes_mm());
  std::mt19937 random(7);
  const auto noise = [&](int, Vec3f* out) {
    for (int n = 0; n < 10000; ++n) {
      for (int c = 0; c < 3; ++c) out[n][c] = float(random());
    }
  };
  for (const char* name : {"a.nii", "b.nii.gz"}) {
    write_warp(folder / name, {kTurned}, turned_vectors);
    const std::string old = read_text(folder / name);
    const std::size_t count = folder.entries().size();
    for (const rlim_t limit : {0, 40, 100000, 260000}) {
      std::string error;
      {
        const FileSizeLimit full(limit);
        error = error_of([&] { write_warp(folder / name, {large}, noise); });
      }
      EXPECT_NE(error.find("cannot write"), std::string::npos) << name << error;
      EXPECT_NE(error.find("File too large"), std::string::npos) << name << error;
      EXPECT_NE(error.find(name), std::string::npos) << error;
    }
    for (const int at : {1, 5}) {  // while it writes three slices, then compresses six planes
      Stop stop;
      stop.at = at;
      const auto write = [&] { write_warp(folder / name, {large}, noise, &stop); };
      if (at == 1 || std::string(name) == "b.nii.gz") {
        EXPECT_THROW(write(), Cancelled);
      }
    }
    EXPECT_EQ(read_text(folder / name), old);
    EXPECT_EQ(folder.entries().size(), count);
  }
}

TEST(FaultNiftiWriter, AFullDiskUnderTheTemporaryFileIsTold) {
  // The vectors are all alike: what is compressed would fit.
  const TemporaryFolder folder;
  const Geometry large({100, 100, 3}, {0, 0, 0}, kTurned.axes_mm());
  const auto alike = [](int, Vec3f* out) { std::fill_n(out, 10000, Vec3f(1, 2, 3)); };
  const FileSizeLimit full(100000);
  EXPECT_EQ(error_of([&] { write_warp(folder / "a.nii.gz", {large}, alike); }),
            (folder / "a.nii.gz") + ": cannot write a temporary file: File too large");
  EXPECT_EQ(folder.entries().size(), 0u);
}
