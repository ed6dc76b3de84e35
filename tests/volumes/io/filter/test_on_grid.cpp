// Volumes on the grids of others, and what files keep when they are replaced.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/errors.h"
#include "tests/support/io_fixtures.h"
#include "volumes/base/error.h"
#include "volumes/io/bytes/output_file.h"
#include "volumes/io/filter/on_grid.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/point_file.h"
#include "volumes/io/volume_writer.h"

namespace supple::test {
namespace {

const Geometry kFrom({9, 8, 7}, {1, -2, 3}, {Vec3d(0, 1.5, 0.3), {-2, 0, 0}, {0, -0.5, 2.5}});

double field(const Vec3d& lps) {
  return 0.5 * lps.x - 0.25 * lps.y + 0.125 * lps.z + 40;
}

std::string write_field(const TemporaryFolder& folder) {
  write_volume(folder / "a.nrrd", kFrom, ValueType::float64, [](int k, float* out) {
    for (int n = 0; n < 72; ++n) {
      out[n] = float(field(kFrom.world_from_index(Vec3d(n % 9, n / 9, k))));
    }
  });
  return folder / "a.nrrd";
}

std::vector<double> on(const std::string& path, const Geometry& grid, ResampleKernel kernel) {
  const auto file = on_grid(open_volume(path), grid, kernel);
  const std::string bytes = read_all(*file);
  std::vector<double> values(std::size_t(grid.voxel_count()));
  scale_values_of(file->header().type)(bytes.data(), values.size(), 1, 0, values.data());
  return values;
}

TEST(UnitOnGrid, ALinearFieldIsTheSameOnEveryGridWithinTheVolume) {
  const TemporaryFolder folder;
  const Vec3d middle = kFrom.world_from_index(Vec3d(4, 3.5, 3));
  const double c = std::cos(0.5), s = std::sin(0.5);
  const Geometry grid({4, 5, 3}, middle - Vec3d(1, 1, 1),
                      {Vec3d(c, s, 0), {-s, c, 0}, {0, 0, 0.7}});
  const std::vector<double> values = on(write_field(folder), grid, ResampleKernel::linear);
  for (int n = 0; n < 60; ++n) {
    const Vec3d place = grid.world_from_index(Vec3d(n % 4, n / 4 % 5, n / 20));
    EXPECT_NEAR(values[std::size_t(n)], field(place), 1e-4) << n;
  }
}

TEST(UnitOnGrid, TheOwnGridGivesTheVoxelsBack) {
  const TemporaryFolder folder;
  const std::string path = write_field(folder);
  for (const ResampleKernel kernel : {ResampleKernel::linear, ResampleKernel::nearest}) {
    const std::vector<double> values = on(path, kFrom, kernel);
    for (int n = 0; n < 9 * 8 * 7; ++n) {
      const Vec3d voxel(n % 9, n / 9 % 8, n / 72);
      EXPECT_NEAR(values[std::size_t(n)], field(kFrom.world_from_index(voxel)), 1e-4) << n;
    }
  }
}

TEST(UnitOnGrid, HalfAVoxelOutsideBelongsToTheBorderAndWhatIsBeyondIsTheMinimum) {
  const TemporaryFolder folder;
  const Geometry line({4, 1, 1}, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  write_volume(folder / "a.nrrd", line, ValueType::int16, [](int, float* out) {
    for (int n = 0; n < 4; ++n) out[n] = float(10 * n - 5);
  });
  const Geometry wide({13, 1, 1}, {-1.4, 0.4, -0.4}, {Vec3d(0.5, 0, 0), {0, 1, 0}, {0, 0, 1}});
  // The places are -1.4, -0.9, -0.4, 0.1, 0.6, ... 4.6.
  EXPECT_EQ(on(folder / "a.nrrd", wide, ResampleKernel::linear),
            (std::vector<double>{-5, -5, -5, -4, 1, 6, 11, 16, 21, 25, -5, -5, -5}));
  EXPECT_EQ(on(folder / "a.nrrd", wide, ResampleKernel::nearest),
            (std::vector<double>{-5, -5, -5, -5, 5, 5, 15, 15, 25, 25, -5, -5, -5}));
  EXPECT_NE(input_error([&] {
              on_grid(open_volume(folder / "a.nrrd"), wide, ResampleKernel::cubic);
            }).find("interpolation"),
            std::string::npos);
}

void write_file(const std::string& path) {
  OutputFile out(path);
  out.write("x");
  out.close();
  out.commit();
}

TEST(UnitOutputNames, NamesOfUpTo255BytesAreWritten) {
  const TemporaryFolder folder;
  for (const std::size_t bytes : {231, 232, 240, 255}) {
    for (const std::string extension : {".nrrd", ".nii.gz", ""}) {
      const std::string name = std::string(bytes - extension.size(), 'n') + extension;
      write_file(folder / name);
      EXPECT_TRUE(std::filesystem::exists(folder / name)) << bytes << extension;
      const std::string part = temporary_part(name);
      EXPECT_EQ(part.compare(part.size() - extension.size(), extension.size(), extension), 0);
    }
  }
  EXPECT_NE(temporary_part(std::string(250, 'a')), temporary_part(std::string(250, 'b')));
  const std::string line = input_error([&] { write_file(folder / std::string(256, 'n')); });
  EXPECT_NE(line.find("a name of 256 bytes, expected at most 255"), std::string::npos) << line;
}

TEST(UnitOutputNames, AFileThatIsReplacedKeepsItsModeBits) {
  const TemporaryFolder folder;
  for (const mode_t mode : {0600, 0640, 0664, 0755}) {
    const std::string path = folder / "a";
    write_file(path);
    ASSERT_EQ(::chmod(path.c_str(), mode), 0);
    write_file(path);
    struct stat status = {};
    ASSERT_EQ(::stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777, mode);
  }
}

TEST(UnitOutputNames, ADashIsToldToBeNoPipe) {
  EXPECT_NE(failure_of("-").find("pipes are not read"), std::string::npos) << failure_of("-");
  EXPECT_NE(input_error([] { read_point_file("-"); }).find("pipes are not read"),
            std::string::npos);
  EXPECT_NE(input_error([] { write_file("-"); }).find("pipes are not written"), std::string::npos);
}

TEST(UnitOutputNames, ABinaryTransformOfAntsNamesWhatConvertsIt) {
  const TemporaryFolder folder;
  const std::int32_t head[] = {0, 12, 1, 0, 28};
  const std::string mat = std::string(reinterpret_cast<const char*>(head), sizeof head) +
                          std::string("AffineTransform_double_3_3\0\0", 28) +
                          std::string(12 * 8, '\1');
  const std::string line = failure_of_warp(folder.write("0GenericAffine.mat", mat));
  EXPECT_NE(line.find("ConvertTransformFile 3"), std::string::npos) << line;
}

}  // namespace
}  // namespace supple::test
