// Label volumes: what is kept of them, and what is refused.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/errors.h"
#include "tests/support/io_fixtures.h"
#include "tests/support/program.h"
#include "volumes/base/error.h"
#include "volumes/io/load/label_file.h"
#include "volumes/io/load/load.h"

namespace supple::test {
namespace {

const Vec3i kDims(19, 11, 9);

int index_of(const Vec3i& voxel) {
  return (voxel.z * kDims.y + voxel.y) * kDims.x + voxel.x;
}

/// Every voxel of the box whose coordinates add up to an even number.
BrickTopology checkerboard() {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (int x = 0; x < kDims.x; x += 8) {
    for (int y = 0; y < kDims.y; y += 8) {
      for (int z = 0; z < kDims.z; z += 8) {
        BrickMask mask{};
        for (int offset = 0; offset < kBrickVoxels; ++offset) {
          const Vec3i voxel = Vec3i(x, y, z) + brick_local(offset);
          const bool inside = voxel.x < kDims.x && voxel.y < kDims.y && voxel.z < kDims.z;
          if (inside && (voxel.x + voxel.y + voxel.z) % 2 == 0) mask_set(mask, offset);
        }
        origins.push_back({x, y, z});
        masks.push_back(mask);
      }
    }
  }
  return {std::move(origins), std::move(masks)};
}

/// NRRD on a grid of 1 x 2 x 3 mm.
template <class T>
std::string write_labels(const TemporaryFolder& folder, const std::vector<T>& values,
                         const std::string& type, const std::string& more = "",
                         const std::string& sizes = "19 11 9",
                         const std::string& axes = "(1,0,0) (0,2,0) (0,0,3)") {
  return folder.write("labels.nrrd",
                      "NRRD0004\ntype: " + type +
                          "\ndimension: 3\nspace: left-posterior-superior\nsizes: " + sizes +
                          "\nspace directions: " + axes +
                          "\nspace origin: (0,0,0)\nencoding: raw\nendian: little\n" + more + "\n" +
                          bytes_of_values(values));
}

Geometry grid() {
  return {kDims, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 2, 0}, {0, 0, 3}}};
}

std::string refusal(const std::string& path) {
  return input_error([&] { read_labels(path, grid(), checkerboard()); });
}

template <class T>
std::vector<T> zeros() {
  return std::vector<T>(std::size_t(kDims.x * kDims.y * kDims.z), T(0));
}

TEST(UnitLabelFile, TheLabelsOfTheElementsAreKeptInWhateverTypeTheyAreStored) {
  const TemporaryFolder folder;
  const BrickTopology elements = checkerboard();
  const auto expect_labels = [&](const std::string& path) {
    const BrickValues labels = read_labels(path, grid(), elements);
    for (std::size_t b = 0; b < elements.brick_count(); ++b) {
      for (int offset = 0; offset < kBrickVoxels; ++offset) {
        const Vec3i voxel = elements.origin(b) + brick_local(offset);
        const int expected = mask_test(elements.mask(b), offset) ? index_of(voxel) % 7 : 0;
        ASSERT_EQ(labels.brick_or_zero(b)[offset], expected) << path;
      }
    }
  };
  const auto values = [&](auto list) {
    for (std::size_t n = 0; n < list.size(); ++n) {
      list[n] = typename decltype(list)::value_type(n % 7);
    }
    return list;
  };
  expect_labels(write_labels(folder, values(zeros<std::uint8_t>()), "uint8"));
  expect_labels(write_labels(folder, values(zeros<std::int64_t>()), "int64"));
  expect_labels(write_labels(folder, values(zeros<float>()), "float"));
}

TEST(UnitLabelFile, OnlyBricksWithLabelsCostMemoryAndNoLabelAtAllCostsNone) {
  const TemporaryFolder folder;
  auto values = zeros<std::uint16_t>();
  EXPECT_EQ(read_labels(write_labels(folder, values, "uint16"), grid(), checkerboard()).bytes(),
            0u);
  values[std::size_t(index_of({1, 0, 0}))] = 9;  // no element
  EXPECT_EQ(read_labels(write_labels(folder, values, "uint16"), grid(), checkerboard()).bytes(),
            0u);
  values[std::size_t(index_of({18, 10, 8}))] = 65535;
  const BrickValues labels =
      read_labels(write_labels(folder, values, "uint16"), grid(), checkerboard());
  EXPECT_EQ(labels.stored_bricks(), 1u);
  EXPECT_EQ(label_counts(labels), (std::map<std::int32_t, std::int64_t>{{65535, 1}}));
}

TEST(UnitLabelFile, MaskAndCountOfALabelAreItsElements) {
  const TemporaryFolder folder;
  auto values = zeros<std::uint16_t>();
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = std::uint16_t(n % 3);
  const BrickTopology elements = checkerboard();
  const BrickValues labels = read_labels(write_labels(folder, values, "uint16"), grid(), elements);
  const auto counts = label_counts(labels);
  ASSERT_EQ(counts.size(), 2u);
  for (const auto& entry : counts) {
    const std::int32_t label = entry.first;
    const BrickTopology mask = label_mask(elements, labels, label);
    EXPECT_EQ(mask.active_count(), entry.second);
    for (std::size_t b = 0; b < mask.brick_count(); ++b) {
      for_each_active(mask.mask(b), [&](int offset) {
        const Vec3i voxel = mask.origin(b) + brick_local(offset);
        EXPECT_TRUE(elements.is_active(voxel) && index_of(voxel) % 3 == label);
      });
    }
  }
  EXPECT_TRUE(label_mask(elements, labels, 3).empty());
}

TEST(FaultLabelFile, ValuesThatAreNoLabelsAreRefusedWithTheirVoxel) {
  const TemporaryFolder folder;
  const auto with = [&](auto list, const Vec3i& voxel, double value, const std::string& type) {
    list[std::size_t(index_of(voxel))] = typename decltype(list)::value_type(value);
    return refusal(write_labels(folder, list, type));
  };
  const auto expect = [](const std::string& line, const std::string& part) {
    EXPECT_NE(line.find(part), std::string::npos) << line;
  };
  EXPECT_EQ(with(zeros<float>(), {3, 2, 8}, 65535, "float"), "");
  expect(with(zeros<float>(), {3, 2, 8}, 1.5, "float"),
         "label at 3,2,8: found 1.5, expected an integer from 0 to 65535");
  expect(with(zeros<std::int8_t>(), {18, 10, 1}, -1, "int8"), "label at 18,10,1: found -1");
  expect(with(zeros<std::int32_t>(), {0, 0, 0}, 65536, "int32"), "label at 0,0,0: found 65536");
  expect(with(zeros<float>(), {1, 0, 8}, std::nan(""), "float"),
         "label at 1,0,8: found not a finite number");
  expect(with(zeros<double>(), {1, 0, 8}, 1e300, "double"), "not a finite number");
}

TEST(FaultLabelFile, AnotherGridIsRefusedAndOneWithinAThousandthOfAVoxelIsNot) {
  const TemporaryFolder folder;
  const auto values = zeros<std::uint8_t>();
  const auto error_of = [&](const std::string& sizes, const std::string& axes) {
    return refusal(write_labels(folder, values, "uint8", "", sizes, axes));
  };
  EXPECT_EQ(error_of("19 11 9", "(1,0,0) (0,2,0) (0,0,3)"), "");
  EXPECT_NE(error_of("19 9 11", "(1,0,0) (0,2,0) (0,0,3)")
                .find("labels.nrrd: dims: found 19,9,11, expected 19,11,9"),
            std::string::npos);
  // The far corner is 18 voxels away: 5e-5 of scale makes 0.9e-3 there, 6e-5 makes 1.08e-3.
  EXPECT_EQ(error_of("19 11 9", "(1.00005,0,0) (0,2,0) (0,0,3)"), "");
  const std::string scaled = error_of("19 11 9", "(1.00006,0,0) (0,2,0) (0,0,3)");
  EXPECT_NE(scaled.find("grid: found voxel 18,0,0 is 0.00108 voxels from where it should be"),
            std::string::npos)
      << scaled;
  EXPECT_NE(error_of("19 11 9", "(1,0,0) (0,-2,0) (0,0,3)").find("grid: found voxel 0,10,0"),
            std::string::npos);
}

TEST(FaultLabelFile, FilesThatAreNoVolumesAreRefusedAsVolumesAre) {
  const TemporaryFolder folder;
  EXPECT_NE(refusal(folder / "none.nii").find("no such file"), std::string::npos);
  const std::string path = write_labels(folder, std::vector<std::uint8_t>(7), "uint8");
  EXPECT_NE(refusal(path).find("7 bytes"), std::string::npos);
}

TEST(UnitRealData, TheAalLabelsLieOnTheBrainTheyWereDrawnOn) {
  const std::string aal = public_volume("aal.nii.gz"), ch2 = public_volume("ch2.nii.gz");
  if (aal.empty() || ch2.empty()) GTEST_SKIP() << "mricron-data is not installed";
  const ElementVolume head = load_elements(ch2, {}, 1, 255, 0);
  const BrickValues labels = read_labels(aal, head.volume.geometry, head.elements);
  const auto counts = label_counts(labels);
  EXPECT_EQ(counts.size(), 116u);
  EXPECT_EQ(counts.begin()->first, 1);
  EXPECT_EQ(counts.rbegin()->first, 116);
  std::int64_t total = 0;
  for (const auto& [label, count] : counts) total += count;
  EXPECT_EQ(label_mask(head.elements, labels, 77).active_count(), counts.at(77));  // left thalamus
  EXPECT_GT(total, 1000000);
  EXPECT_LT(labels.bytes(), 20000000u);
}

}  // namespace
}  // namespace supple::test
