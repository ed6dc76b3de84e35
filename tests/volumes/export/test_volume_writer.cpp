#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/errors.h"
#include "tests/support/random_state.h"
#include "tests/support/temporary_folder.h"
#include "volumes/base/error.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"
#include "volumes/io/volume_writer.h"

using namespace supple;
using namespace supple::test;

namespace {

const Geometry kOblong({3, 2, 2}, {1.5, -2, 0.1}, {Vec3d(0, 0.5, 0), {-2, 0, 0}, {0, 0, 3}});
const Geometry kSheared({3, 2, 2}, {0, 0, 0}, {Vec3d(1, 0, 0), {0.2, 1, 0}, {0, 0, 1}});

void counting_slices(int k, float* out) {
  for (int n = 0; n < 6; ++n) out[n] = float(10 * k + n);
}

void counting_vectors(int k, Vec3f* out) {
  for (int n = 0; n < 6; ++n) out[n] = Vec3f(float(k), float(n), -0.5f);
}

std::string values_of_counting_vectors() {
  std::vector<Vec3f> vectors(12);
  counting_vectors(0, vectors.data());
  counting_vectors(1, vectors.data() + 6);
  return {reinterpret_cast<const char*>(vectors.data()), 12 * sizeof(Vec3f)};
}

template <class Value>
std::vector<Value> written_as(ValueType type, const std::vector<float>& values) {
  const TemporaryFolder folder;
  const Geometry row = Geometry().with_dims({int(values.size()), 1, 1});
  write_volume(folder / "a.nrrd", row, type,
               [&](int, float* out) { std::copy(values.begin(), values.end(), out); });
  const std::string bytes = read_text(folder / "a.nrrd");
  std::vector<Value> stored(values.size());
  std::memcpy(stored.data(), bytes.data() + bytes.size() - stored.size() * sizeof(Value),
              stored.size() * sizeof(Value));
  return stored;
}

}  // namespace

TEST(UnitWriter, AnNrrdWarpHasExactlyTheFieldsOfTheDesign) {
  const TemporaryFolder folder;
  write_warp(folder / "a.nrrd", {kOblong, WarpDirection::resample}, counting_vectors);
  EXPECT_EQ(read_text(folder / "a.nrrd"),
            "NRRD0004\n"
            "# written by supple\n"
            "type: float\n"
            "dimension: 4\n"
            "space: left-posterior-superior\n"
            "sizes: 3 3 2 2\n"
            "space directions: none (0,0.5,0) (-2,0,0) (0,0,3)\n"
            "kinds: vector domain domain domain\n"
            "endian: little\n"
            "encoding: raw\n"
            "space origin: (1.5,-2,0.1)\n"
            "space units: \"mm\" \"mm\" \"mm\"\n"
            "supple direction:=resample\n"
            "supple vectors:=mm LPS\n"
            "displacement field type:=resampling\n"
            "\n" +
                values_of_counting_vectors());
}

TEST(UnitWriter, AMetaImageWarpIsInterleavedFloatWithTheDirectionAsComment) {
  const TemporaryFolder folder;
  write_warp(folder / "a.mha", {kOblong, WarpDirection::material}, counting_vectors);
  EXPECT_EQ(read_text(folder / "a.mha"),
            "Comment = supple direction material, vectors in mm LPS\n"
            "ObjectType = Image\n"
            "NDims = 3\n"
            "BinaryData = True\n"
            "BinaryDataByteOrderMSB = False\n"
            "CompressedData = False\n"
            "TransformMatrix = 0 1 0 -1 0 0 0 0 1\n"
            "Offset = 1.5 -2 0.1\n"
            "CenterOfRotation = 0 0 0\n"
            "ElementSpacing = 0.5 2 3\n"
            "DimSize = 3 2 2\n"
            "ElementNumberOfChannels = 3\n"
            "ElementType = MET_FLOAT\n"
            "ElementDataFile = LOCAL\n" +
                values_of_counting_vectors());
}

TEST(UnitWriter, DetachedHeadersNameTheRawFileBesideThem) {
  const TemporaryFolder folder;
  write_warp(folder / "a.nhdr", {kOblong, WarpDirection::resample}, counting_vectors);
  EXPECT_NE(read_text(folder / "a.nhdr").find("\ndata file: a.raw\n"), std::string::npos);
  EXPECT_EQ(read_text(folder / "a.raw"), values_of_counting_vectors());
  write_warp(folder / "b.MHD", {kOblong, WarpDirection::resample}, counting_vectors);
  EXPECT_NE(read_text(folder / "b.MHD").find("ElementDataFile = b.raw\n"), std::string::npos);
  EXPECT_EQ(read_text(folder / "b.raw"), values_of_counting_vectors());
  EXPECT_EQ(folder.entries().size(), 4u);
  EXPECT_EQ(output_files("x/b.mhd"), (std::vector<std::string>{"x/b.mhd", "x/b.raw"}));
  EXPECT_EQ(output_files("b.mha"), std::vector<std::string>{"b.mha"});
}

TEST(UnitWriter, IntegersAreRoundedAndClampedAndNanIsZero) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> values = {nan, -inf, inf, -1e30f, 1e30f, 2.5f, -2.5f, 2.4f, 300, -300};
  EXPECT_EQ(written_as<std::int8_t>(ValueType::int8, values),
            (std::vector<std::int8_t>{0, -128, 127, -128, 127, 3, -3, 2, 127, -128}));
  EXPECT_EQ(written_as<std::uint8_t>(ValueType::uint8, values),
            (std::vector<std::uint8_t>{0, 0, 255, 0, 255, 3, 0, 2, 255, 0}));
  EXPECT_EQ(written_as<std::int16_t>(ValueType::int16, values)[9], -300);
  EXPECT_EQ(written_as<std::uint16_t>(ValueType::uint16, values)[2], 65535);
  EXPECT_EQ(written_as<std::int32_t>(ValueType::int32, values)[4], 2147483647);
  EXPECT_EQ(written_as<std::uint32_t>(ValueType::uint32, values)[4], 4294967295u);
  const auto int64_out = written_as<std::int64_t>(ValueType::int64, values);
  EXPECT_EQ(int64_out[3], std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(int64_out[4], std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(int64_out[8], 300);
  const auto uint64_out = written_as<std::uint64_t>(ValueType::uint64, values);
  EXPECT_EQ(uint64_out[1], 0u);
  EXPECT_EQ(uint64_out[4], std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(uint64_out[5], 3u);
  EXPECT_TRUE(std::isnan(written_as<float>(ValueType::float32, values)[0]));
  EXPECT_EQ(written_as<double>(ValueType::float64, values)[7], double(2.4f));
}

TEST(PropertyWriter, OurReadersGiveBackGeometryAndValuesOfEveryFormatAndType) {
  const TemporaryFolder folder;
  std::mt19937 random(3);
  for (int n = 0; n < 100; ++n) {
    const Vec3i dims(1 + int(random() % 9), 1 + int(random() % 9), 1 + int(random() % 9));
    const char* name =
        std::array<const char*, 5>{"a.nrrd", "a.nhdr", "a.mha", "a.mhd", "a.h5"}[n % 5];
    Geometry geometry = random_geometry(random, dims);
    if (n % 5 >= 2) {  // MetaImage and HDF5 take no shear
      const auto unit = geometry.direction();
      const Vec3d second = unit[0].cross(unit[1]).normalized();
      geometry = Geometry(dims, geometry.origin_lps_mm(),
                          {unit[0] * 0.7, second * 1.9, unit[0].cross(second) * -3.1});
    }
    const auto type = ValueType(n / 5 % 10);
    const auto grey = [&](int i, int j, int k) { return float((i * 7 + j * 13 + k * 29) % 100); };
    write_volume(folder / name, geometry, type, [&](int k, float* out) {
      for (int j = 0; j < dims.y; ++j) {
        for (int i = 0; i < dims.x; ++i) *out++ = grey(i, j, k);
      }
    });

    const Volume volume = load_volume(folder / name);
    EXPECT_EQ(volume.value_type, numpy_name(type));
    EXPECT_EQ(volume.geometry.dims(), dims);
    for (int c = 0; c < 3; ++c) {
      EXPECT_LT((volume.geometry.axes_mm()[c] - geometry.axes_mm()[c]).length(), 1e-12) << name;
    }
    EXPECT_EQ(volume.geometry.origin_lps_mm(), geometry.origin_lps_mm()) << name;
    for (int k = 0; k < dims.z; ++k) {
      for (int j = 0; j < dims.y; ++j) {
        for (int i = 0; i < dims.x; ++i) ASSERT_EQ(volume.density.at({i, j, k}), grey(i, j, k));
      }
    }
  }
}

TEST(FaultWriter, ShearIsKeptByNrrdAndRefusedByMetaImage) {
  const TemporaryFolder folder;
  for (const char* name : {"a.mha", "a.mhd", "a.h5"}) {
    const std::string error = error_of([&] {
      write_warp(folder / name, {kSheared, WarpDirection::resample}, counting_vectors);
    });
    EXPECT_NE(error.find("geometry: found sheared axes"), std::string::npos) << error;
  }
  EXPECT_EQ(folder.entries().size(), 0u);
  write_volume(folder / "a.nrrd", kSheared, ValueType::int16, counting_slices);
  EXPECT_TRUE(load_volume(folder / "a.nrrd").geometry == kSheared);
}

TEST(FaultWriter, AnUnknownExtensionListsTheKnownOnes) {
  const auto write = [](const char* path) {
    return error_of([&] { write_volume(path, kOblong, ValueType::uint8, counting_slices); });
  };
  const std::string known = "expected .nrrd, .nhdr, .mha, .mhd, ";
  EXPECT_EQ(write("a.txt").find("a.txt: extension: found .txt, " + known), 0u) << write("a.txt");
  EXPECT_EQ(write("a").find("a: extension: found none, " + known), 0u) << write("a");
}

TEST(FaultWriter, AFullDiskIsASystemErrorThatKeepsTheOldFilesAndLeavesNothingElse) {
  const TemporaryFolder folder;
  const Geometry large({200, 100, 3}, {0, 0, 0}, kOblong.axes_mm());
  const auto slices = [](int, float* out) { std::fill_n(out, 20000, 1.0f); };
  for (const char* name : {"a.nrrd", "a.nhdr", "b.mha", "b.mhd", "c.tif", "d.h5"}) {
    write_volume(folder / name, kOblong, ValueType::float32, counting_slices);
    const std::string old = read_text(folder / name);
    const std::size_t count = folder.entries().size();
    for (const rlim_t limit : {0, 40, 100000, 239999}) {
      std::string error;
      {
        const FileSizeLimit full(limit);
        error = error_of([&] { write_volume(folder / name, large, ValueType::float32, slices); });
      }
      EXPECT_NE(error.find("cannot write: File too large"), std::string::npos) << name << error;
      EXPECT_EQ(read_text(folder / name), old);
      EXPECT_EQ(folder.entries().size(), count);
    }
    EXPECT_EQ(load_volume(folder / name).geometry.dims(), kOblong.dims());
  }
}

TEST(FaultWriter, CancellingLeavesNoFile) {
  struct Stop : Progress {
    void stage(std::string_view) override {}
    void update(double) override { ++slices; }
    bool cancelled() const override { return slices == 1; }
    int slices = 0;
  } stop;
  const TemporaryFolder folder;
  EXPECT_THROW(write_volume(folder / "a.nhdr", kOblong, ValueType::uint8, counting_slices, &stop),
               Cancelled);
  EXPECT_EQ(folder.entries().size(), 0u);
}

TEST(FaultWriter, AMissingFolderIsAnInputError) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_volume(folder / "none/a.mha", kOblong, ValueType::uint8, counting_slices),
               InputError);
}
