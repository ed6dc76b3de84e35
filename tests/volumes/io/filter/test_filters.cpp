// Filters between a file and its reader, against sums over all voxels.
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/errors.h"
#include "tests/support/io_fixtures.h"
#include "volumes/base/error.h"
#include "volumes/grid/b_spline.h"
#include "volumes/io/filter/filters.h"

using namespace supple;
using namespace supple::test;

namespace {

const Vec3i kFilterDims(7, 6, 5);
/// Oblique, anisotropic and left-handed.
const Geometry kFilterGrid(kFilterDims, {5, -3, 2},
                           {Vec3d(0, 1.5, 0.3), {-2, 0, 0}, {0, 0.5, 2.5}});

/// Values in memory as a file that is read.
template <class T>
class MemoryVolume final : public VolumeFile {
 public:
  MemoryVolume(ValueType type, std::vector<T> values, int components = 1)
      : m_values(std::move(values)) {
    m_header.path = "memory";
    m_header.geometry = kFilterGrid;
    m_header.type = type;
    m_header.components = components;
    m_per_slice = std::size_t(kFilterDims.x) * std::size_t(kFilterDims.y) * std::size_t(components);
  }
  void scale_by(double slope, double intercept) {
    m_header.slope = slope;
    m_header.intercept = intercept;
  }
  void read_slice(void* out) override {
    ASSERT_LE((m_next + 1) * m_per_slice, m_values.size());
    std::memcpy(out, &m_values[m_next++ * m_per_slice], m_per_slice * sizeof(T));
  }

 private:
  std::vector<T> m_values;
  std::size_t m_per_slice, m_next = 0;
};

std::size_t index_of(const Vec3i& v) {
  return std::size_t(v.x) + std::size_t(kFilterDims.x) *
                                (std::size_t(v.y) + std::size_t(kFilterDims.y) * std::size_t(v.z));
}

template <class Visit>
void for_each_voxel(const Vec3i& dims, Visit&& visit) {
  for (int k = 0; k < dims.z; ++k) {
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i) visit(Vec3i(i, j, k));
    }
  }
}

std::vector<float> noise() {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> value(-100, 100);
  std::vector<float> values(std::size_t(kFilterGrid.voxel_count()));
  for (float& v : values) v = value(random);
  return values;
}

template <class T>
std::vector<T> values_of(VolumeFile& file) {
  const std::string bytes = read_all(file);
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

template <class T>
std::unique_ptr<VolumeFile> in_memory(ValueType type, std::vector<T> values, int components = 1) {
  return std::make_unique<MemoryVolume<T>>(type, std::move(values), components);
}
std::unique_ptr<VolumeFile> in_memory(std::vector<float> values) {
  return in_memory(ValueType::float32, std::move(values));
}

}  // namespace

TEST(UnitFilters, ACropHasTheValuesOfItsVoxelsAtTheirPlaces) {
  const std::vector<float> whole = noise();
  for (const int components : {1, 3}) {
    std::vector<float> values;
    for (std::size_t n = 0; n < whole.size(); ++n) {
      for (int c = 0; c < components; ++c) values.push_back(whole[n] + float(c));
    }
    const IndexBox box{{1, 2, 1}, {5, 2, 3}};
    const auto file = crop(in_memory(ValueType::float32, values, components), box);
    const Vec3i dims = file->header().geometry.dims();
    EXPECT_EQ(dims, Vec3i(5, 1, 3));
    const std::vector<float> found = values_of<float>(*file);
    std::size_t n = 0;
    for_each_voxel(dims, [&](const Vec3i& v) {
      for (int c = 0; c < components; ++c) {
        ASSERT_EQ(found[n++], whole[index_of(v + box.lo)] + float(c));
      }
      const Vec3d apart = file->header().geometry.world_from_index(Vec3d(v)) -
                          kFilterGrid.world_from_index(Vec3d(v + box.lo));
      ASSERT_LT(apart.length(), 1e-12);
    });
  }
}

TEST(UnitFilters, ABoxOfDensitiesHoldsThemAllAndTheMargin) {
  std::vector<float> values(std::size_t(kFilterGrid.voxel_count()));
  values[index_of({2, 3, 1})] = 50;
  values[index_of({4, 3, 2})] = 60;
  values[index_of({0, 0, 0})] = 61;
  EXPECT_EQ(box_of_densities(*in_memory(values), 50, 60, 0), (IndexBox{{2, 3, 1}, {4, 3, 2}}));
  // Spacings are 1.53, 2 and 2.55 mm.
  EXPECT_EQ(box_of_densities(*in_memory(values), 50, 60, 1.6), (IndexBox{{0, 2, 0}, {6, 4, 3}}));
  EXPECT_EQ(error_of([&] { box_of_densities(*in_memory(values), 70, 80, 0); }),
            "memory: range: found no voxel with a density of 70 to 80, expected densities that the "
            "volume has");
}

TEST(PropertyFilters, SmoothingIsTheSumOverAllVoxelsWithinFourDeviations) {
  std::vector<float> values = noise();
  values[index_of({3, 2, 2})] = std::numeric_limits<float>::quiet_NaN();
  for (const int i : {0, 1}) {
    for (const int j : {4, 5}) values[index_of({i, j, 4})] = std::numeric_limits<float>::infinity();
  }
  const double sigma_mm = 1.25;
  const auto file = smooth(in_memory(values), sigma_mm);
  EXPECT_EQ(file->header().geometry, kFilterGrid);
  const std::vector<float> found = values_of<float>(*file);
  const Vec3d h = kFilterGrid.spacing_mm();
  int unknown = 0;
  for_each_voxel(kFilterDims, [&](const Vec3i& v) {
    double sum = 0, known = 0, all = 0;
    for_each_voxel(kFilterDims, [&](const Vec3i& w) {
      double weight = 1;
      for (int a = 0; a < 3; ++a) {
        const double d = (w[a] - v[a]) * h[a] / sigma_mm;
        weight *= std::abs(d) <= 4 ? std::exp(-d * d / 2) : 0;
      }
      all += weight;
      if (!std::isfinite(values[index_of(w)])) return;
      known += weight;
      sum += weight * values[index_of(w)];
    });
    if (known < 0.5 * all) {
      ASSERT_TRUE(std::isnan(found[index_of(v)]));
      ++unknown;
    } else {
      ASSERT_NEAR(found[index_of(v)], sum / known, 1e-4);
    }
  });
  EXPECT_GT(unknown, 0);
}

TEST(PropertyFilters, OtherSpacingsKeepTheBoxAndEveryLinearFunctionInside) {
  std::vector<float> values(std::size_t(kFilterGrid.voxel_count()));
  const auto density = [](const Vec3d& x) { return 3 * x.x - 2 * x.y + 0.5 * x.z + 7; };
  for_each_voxel(kFilterDims, [&](const Vec3i& v) {
    values[index_of(v)] = float(density(kFilterGrid.world_from_index(Vec3d(v))));
  });
  const Vec3d h = kFilterGrid.spacing_mm();
  for (const Vec3d& factor : {Vec3d(0.5, 0.5, 0.25), Vec3d(1, 0.7, 0.4), Vec3d(1.75, 2, 1)}) {
    const auto file = with_spacing(in_memory(values), h * factor);
    const Geometry& grid = file->header().geometry;
    EXPECT_LT((grid.spacing_mm() - h * factor).length(), 1e-12);
    const Vec3d corner = grid.world_from_index(Vec3d(-0.5));
    EXPECT_LT((corner - kFilterGrid.world_from_index(Vec3d(-0.5))).length(), 1e-12);
    const std::vector<float> found = values_of<float>(*file);
    std::size_t n = 0;
    int inside = 0;
    for_each_voxel(grid.dims(), [&](const Vec3i& v) {
      const Vec3d x = grid.world_from_index(Vec3d(v));
      const Vec3d at = kFilterGrid.index_from_world(x);
      bool is_inside = true;
      for (int a = 0; a < 3; ++a) {
        const double reach = factor[a] > 1 ? factor[a] : 0;
        is_inside = is_inside && at[a] >= reach && at[a] <= kFilterDims[a] - 1 - reach;
      }
      // A wide hat weighs both sides alike only in the middle of a voxel or between two.
      const bool is_even = factor.x <= 1;
      if (is_inside && is_even) {
        ASSERT_NEAR(found[n], density(x), 1e-3);
      }
      inside += is_inside;
      ++n;
    });
    EXPECT_GT(inside, 0);
  }
}

/// The spline of b_spline.h, which filters recursively, at the same places.
TEST(PropertyFilters, CubicSpacingsReadTheSplineThroughAllVoxels) {
  const std::vector<float> values = noise();
  BrickMask mask{};
  std::vector<float> brick(kBrickVoxels);
  for_each_voxel(kFilterDims, [&](const Vec3i& v) {
    mask_set(mask, brick_offset(v));
    brick[std::size_t(brick_offset(v))] = values[index_of(v)];
  });
  const DensityGrid density = make_density_grid({{Vec3i(0)}, {mask}}, brick, 0);
  const SplineDensity spline(density, kFilterDims, true);
  const Vec3d factor(1.0 / 3, 0.5, 0.4);
  const auto file =
      with_spacing(in_memory(values), kFilterGrid.spacing_mm() * factor, ResampleKernel::cubic);
  const Geometry grid = file->header().geometry;
  const std::vector<float> found = values_of<float>(*file);
  std::size_t n = 0;
  for_each_voxel(grid.dims(), [&](const Vec3i& v) {
    Vec3d at = kFilterGrid.index_from_world(grid.world_from_index(Vec3d(v)));
    for (int a = 0; a < 3; ++a) at[a] = std::clamp(at[a], 0.0, kFilterDims[a] - 1.0);
    ASSERT_NEAR(found[n++], spline.at(at), 0.01);
  });
}

TEST(PropertyFilters, WiderVoxelsTakeTheMeanOfAHatOfTheirWidth) {
  const std::vector<float> values = noise();
  const Vec3d factor(2, 2, 2.5);
  const auto file = with_spacing(in_memory(values), kFilterGrid.spacing_mm() * factor);
  const Vec3i dims = file->header().geometry.dims();
  EXPECT_EQ(dims, Vec3i(4, 3, 2));
  const std::vector<float> found = values_of<float>(*file);
  std::size_t n = 0;
  for_each_voxel(dims, [&](const Vec3i& v) {
    double sum = 0, weights = 0;
    for_each_voxel(kFilterDims, [&](const Vec3i& w) {
      double weight = 1;
      for (int a = 0; a < 3; ++a) {
        const double place = std::min((v[a] + 0.5) * factor[a] - 0.5, kFilterDims[a] - 1.0);
        weight *= std::max(0.0, 1 - std::abs(w[a] - place) / factor[a]);
      }
      sum += weight * values[index_of(w)];
      weights += weight;
    });
    ASSERT_NEAR(found[n++], sum / weights, 1e-4);
  });
}

TEST(UnitFilters, LabelsTakeTheNearestVoxelAndIntegersStay) {
  std::vector<std::int16_t> labels(std::size_t(kFilterGrid.voxel_count()));
  for (std::size_t n = 0; n < labels.size(); ++n) labels[n] = std::int16_t(n * 37 % 101);
  const Vec3d factor(0.5, 1, 1.0 / 3);
  const auto file = with_spacing(in_memory(ValueType::int16, labels),
                                 kFilterGrid.spacing_mm() * factor, ResampleKernel::nearest);
  const Vec3i dims = file->header().geometry.dims();
  EXPECT_EQ(dims, Vec3i(14, 6, 15));
  const std::vector<std::int16_t> found = values_of<std::int16_t>(*file);
  std::size_t n = 0;
  for_each_voxel(dims, [&](const Vec3i& v) {
    ASSERT_EQ(found[n++], labels[index_of({v.x / 2, v.y, v.z / 3})]);
  });
}

TEST(UnitFilters, AThresholdGoesByDensitiesAndWritesStoredValues) {
  std::vector<std::int16_t> stored(std::size_t(kFilterGrid.voxel_count()));
  for (std::size_t n = 0; n < stored.size(); ++n) stored[n] = std::int16_t(n);
  const auto scaled = [&] {
    auto file = std::make_unique<MemoryVolume<std::int16_t>>(ValueType::int16, stored);
    file->scale_by(2, -100);  // densities of -100, -98 …
    return file;
  };
  Threshold range;
  range.lo = -90;
  range.hi = -80;
  const auto of_minimum = values_of<std::int16_t>(*threshold(scaled(), range, -100));
  range.outside = -60;
  const auto of_outside = values_of<std::int16_t>(*threshold(scaled(), range, -100));
  range.is_mask = true;
  const auto mask = threshold(scaled(), range, -100);
  EXPECT_EQ(mask->header().type, ValueType::uint8);
  EXPECT_EQ(mask->header().slope, 1);
  EXPECT_EQ(mask->header().intercept, 0);
  const auto of_mask = values_of<std::uint8_t>(*mask);
  for (std::size_t n = 0; n < stored.size(); ++n) {
    const bool stays = n >= 5 && n <= 10;
    ASSERT_EQ(of_minimum[n], stays ? int(n) : 0);
    ASSERT_EQ(of_outside[n], stays ? int(n) : 20);
    ASSERT_EQ(of_mask[n], stays);
  }
}

TEST(FaultFilters, WhatCannotBeIsOneLine) {
  const auto expect = [](const std::string& line, auto&& make) {
    EXPECT_EQ(error_of([&] { make(in_memory(noise())); }), line);
  };
  using File = std::unique_ptr<VolumeFile>;
  expect("memory: box: found 0,0,0:7,1,1, expected a box within 0,0,0:6,5,4", [](File file) {
    crop(std::move(file), {{0, 0, 0}, {7, 1, 1}});
  });
  expect("memory: sigma: found nan, expected a length in mm, at most 1000 voxels",
         [](File file) { smooth(std::move(file), std::nan("")); });
  expect(
      "memory: spacing: found 0, expected lengths in mm that give at most 1e9 voxels along an axis",
      [](File file) {
        with_spacing(std::move(file), {1, 0, 1});
      });
  expect(
      "memory: spacing: found 1e-12, expected lengths in mm that give at most 1e9 voxels along an "
      "axis",
      [](File file) {
        with_spacing(std::move(file), {1e-12, 1, 1});
      });
}
