// Displacement, Jacobian and folds of bodies whose deformation is known.
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "volumes/base/error.h"
#include "volumes/field/inversion/deformation_metrics.h"

namespace supple::test {
namespace {

const Geometry kScan({12, 11, 10}, {5, -3, 2}, {Vec3d(0, 0.5, 0.1), {-2, 0, 0}, {0, 0.2, 3}});

/// Voxels 1 … 9 per axis.
BrickTopology block() {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3i origin(8 * (corner >> 2), 8 * ((corner >> 1) & 1), 8 * (corner & 1));
    BrickMask mask{};
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      const Vec3i v = origin + brick_local(offset);
      if (std::min({v.x, v.y, v.z}) >= 1 && std::max({v.x, v.y, v.z}) <= 9) mask_set(mask, offset);
    }
    origins.push_back(origin);
    masks.push_back(mask);
  }
  return {origins, masks};
}

Displacement displaced(const BrickTopology& elements, const std::function<Vec3d(Vec3d)>& u) {
  Displacement displacement{kScan, {elements, {}}};
  displacement.u.vectors.resize(elements.brick_count());
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for_each_active(elements.mask(b), [&](int offset) {
      displacement.u.vectors.touch(b)[offset] =
          Vec3f(u(Vec3d(elements.origin(b) + brick_local(offset))));
    });
  }
  return displacement;
}

DeformationSummary summary_of(const std::function<Vec3d(Vec3d)>& u, const LinkCuts& cuts = {}) {
  const BrickTopology elements = block();
  return summarize(map_deformation(displaced(elements, u), elements, cuts), kScan);
}

TEST(UnitDeformationMetrics, AShiftMovesEveryElementAndKeepsVolume) {
  const Vec3d step(0.5, -0.25, 1);
  const DeformationSummary summary = summary_of([&](const Vec3d&) { return step; });
  const double length = kScan.world_vector_from_index(step).length();
  EXPECT_EQ(summary.elements, 729);
  EXPECT_EQ(summary.moved, 729);
  for (const double found : {summary.mean_mm, summary.rms_mm, summary.p95_mm, summary.max_mm}) {
    EXPECT_NEAR(found, length, 1e-6);
  }
  EXPECT_EQ(summary.min_jacobian, 1);
  EXPECT_EQ(summary.max_jacobian, 1);
  EXPECT_NEAR(summary.rest_volume_mm3, 729 * std::abs(kScan.determinant()), 1e-9);
  EXPECT_EQ(summary.volume_change(), 0);
}

TEST(UnitDeformationMetrics, EveryStatisticIsThatOfTheLengths) {
  // Element n of 729 moves by n hundredths of a voxel along i.
  const double step_mm = 0.01 * kScan.world_vector_from_index({1, 0, 0}).length();
  const auto rank = [](const Vec3d& x) { return 81 * (x.x - 1) + 9 * (x.y - 1) + x.z - 1; };
  const DeformationSummary summary =
      summary_of([&](const Vec3d& x) { return Vec3d(0.01 * rank(x), 0, 0); });
  EXPECT_EQ(summary.elements, 729);
  EXPECT_EQ(summary.moved, 728);
  EXPECT_NEAR(summary.mean_mm, 364 * step_mm, 1e-6);
  EXPECT_NEAR(summary.rms_mm, std::sqrt(728 * 1457 / 6.0) * step_mm, 1e-6);
  EXPECT_NEAR(summary.p95_mm, 692 * step_mm, 1e-6);  // the 693rd of 729 lengths
  EXPECT_NEAR(summary.max_mm, 728 * step_mm, 1e-6);
}

TEST(UnitDeformationMetrics, AnAffineMapHasItsDeterminantEverywhere) {
  const DeformationSummary summary = summary_of([](const Vec3d& x) {
    return Vec3d(0.25 * x.x + 0.5 * x.y, 0.125 * x.y, -0.5 * x.z + 0.25 * x.x);
  });
  EXPECT_NEAR(summary.min_jacobian, 1.25 * 1.125 * 0.5, 1e-6);
  EXPECT_NEAR(summary.max_jacobian, 1.25 * 1.125 * 0.5, 1e-6);
  EXPECT_NEAR(summary.volume_change(), 1.25 * 1.125 * 0.5 - 1, 1e-6);
  EXPECT_EQ(summary.folded_cells, 0);
}

TEST(UnitDeformationMetrics, InsideTheBodyDifferencesAreCentral) {
  const BrickTopology elements = block();
  const auto u = [](const Vec3d& x) { return Vec3d(0.01 * x.x * x.x, 0, 0); };
  const DeformationMaps maps = map_deformation(displaced(elements, u), elements, {});
  const auto at = [&](const Vec3i& v) {
    return maps.jacobian[elements.find(v) * kBrickVoxels + brick_offset(v)];
  };
  EXPECT_NEAR(at({5, 5, 5}), 1 + 0.02 * 5, 1e-5);
  EXPECT_NEAR(at({1, 5, 5}), 1 + 0.01 * (4 - 1), 1e-5);    // forward at the surface
  EXPECT_NEAR(at({9, 5, 5}), 1 + 0.01 * (81 - 64), 1e-5);  // backward
}

TEST(UnitDeformationMetrics, FoldsAreCountedAtTheLowestCornersOfTheirCells) {
  const auto fold = [](const Vec3d& x) { return Vec3d(x.x >= 6 ? -1.5 : 0.0, 0, 0); };
  const DeformationSummary summary = summary_of(fold);
  EXPECT_EQ(summary.folded_cells, 8 * 8);  // the cells between x = 5 and 6
  EXPECT_NEAR(summary.min_jacobian, 1 - 0.75, 1e-6);
}

TEST(UnitDeformationMetrics, NothingIsDifferencedAcrossACut) {
  const BrickTopology elements = block();
  LinkCuts cuts;
  for (int y = 1; y <= 9; ++y) {
    for (int z = 1; z <= 9; ++z) {
      const Vec3i voxel(5, y, z);
      cuts.cut(std::size_t(elements.find(voxel)), brick_offset(voxel), 0);
    }
  }
  const auto apart = [](const Vec3d& x) { return Vec3d(x.x >= 6 ? -1.5 : 0.0, 0, 0); };
  const DeformationSummary summary = summary_of(apart, cuts);
  EXPECT_EQ(summary.folded_cells, 0);
  EXPECT_EQ(summary.min_jacobian, 1);
  EXPECT_EQ(summary.max_jacobian, 1);
}

TEST(UnitDeformationMetrics, LabelsAreSummedApartAndTogetherMakeTheWhole) {
  const BrickTopology elements = block();
  const auto u = [](const Vec3d& x) { return Vec3d(x.x >= 5 ? 0.5 * (x.x - 5) : 0.0, 0, 0); };
  const DeformationMaps maps = map_deformation(displaced(elements, u), elements, {});
  BrickValues labels(elements.brick_count());
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for_each_active(elements.mask(b), [&](int offset) {
      if ((elements.origin(b) + brick_local(offset)).x >= 7) {
        labels.set(b * kBrickVoxels + offset, 4);
      }
    });
  }
  auto rows = summarize_labels(maps, labels, kScan);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[4].elements, 3 * 81);
  EXPECT_NEAR(rows[4].volume_change(), 0.5, 1e-6);
  EXPECT_EQ(rows[0].elements, 6 * 81);
  const DeformationSummary whole = summarize(maps, kScan);
  EXPECT_NEAR(rows[0].volume_mm3 + rows[4].volume_mm3, whole.volume_mm3, 1e-6);
  EXPECT_EQ(rows[0].moved + rows[4].moved, whole.moved);
}

/// u by world place, for the voxels of kScan.
std::function<Vec3d(Vec3d)> in_world(const std::function<Vec3d(Vec3d)>& u_mm) {
  return [u_mm](const Vec3d& x) {
    return kScan.index_vector_from_world(u_mm(kScan.world_from_index(x)));
  };
}

TEST(UnitDeformationMetrics, AnAffineMapDoesNotBend) {
  const DeformationSummary summary =
      summary_of([](const Vec3d& x) { return Vec3d(0.25 * x.x + 0.5 * x.y, 1 - x.y, 0.3 * x.z); });
  ASSERT_TRUE(summary.bending_per_mm2);
  EXPECT_LT(*summary.bending_per_mm2, 1e-10);
}

TEST(UnitDeformationMetrics, BendingIsTheSquaredNormOfTheHessiansInWorldCoordinates) {
  // u_c = x^T Q_c x / 2 in mm, whose Hessians are Q_c, on a sheared grid of unequal steps.
  const double Q[3][3][3] = {{{0.02, 0.01, -0.03}, {0.01, -0.04, 0.02}, {-0.03, 0.02, 0.01}},
                             {{0, 0.05, 0}, {0.05, 0, 0}, {0, 0, 0}},
                             {{0.01, 0, 0}, {0, 0.01, 0}, {0, 0, -0.02}}};
  double expected = 0;
  for (const auto& component : Q) {
    for (const auto& row : component) {
      for (const double value : row) expected += value * value;
    }
  }
  const auto quadratic = in_world([&](const Vec3d& x) {
    Vec3d u(0);
    for (int c = 0; c < 3; ++c) {
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) u[c] += 0.5 * x[a] * Q[c][a][b] * x[b];
      }
    }
    return u;
  });
  const DeformationSummary summary = summary_of(quadratic);
  ASSERT_TRUE(summary.bending_per_mm2);
  EXPECT_NEAR(*summary.bending_per_mm2 / expected, 1, 2e-4);
}

TEST(UnitDeformationMetrics, BendingIsTakenOnlyWhereEveryNeighbourIsThereAndLinked) {
  const BrickTopology elements = block();
  LinkCuts cuts;
  for (int y = 1; y <= 9; ++y) {
    for (int z = 1; z <= 9; ++z) {
      const Vec3i voxel(5, y, z);
      cuts.cut(std::size_t(elements.find(voxel)), brick_offset(voxel), 0);
    }
  }
  const auto apart = [](const Vec3d& x) { return Vec3d(x.x >= 6 ? 1.5 : 0.0, 0, 0); };
  const auto bent = [&](const LinkCuts& by) {
    const DeformationMaps maps = map_deformation(displaced(elements, apart), elements, by);
    int count = 0;
    for (const float bending : maps.bending_per_mm2) count += !std::isnan(bending);
    return std::pair(count, *summarize(maps, kScan).bending_per_mm2);
  };
  EXPECT_EQ(bent({}).first, 7 * 7 * 7);
  EXPECT_GT(bent({}).second, 0.01);
  EXPECT_EQ(bent(cuts).first, 5 * 7 * 7);  // not beside the cut
  EXPECT_EQ(bent(cuts).second, 0);
}

TEST(UnitDeformationMetrics, ASliceBendsInItsPlane) {
  const Geometry slice({9, 8, 1}, {0, 0, 0}, {Vec3d(2, 0, 0), {0, 3, 0}, {0, 0, 1}});
  std::vector<BrickMask> masks(2);
  for (int x = 0; x < 9; ++x) {
    for (int y = 0; y < 8; ++y) mask_set(masks[std::size_t(x / 8)], brick_offset({x, y, 0}));
  }
  const BrickTopology elements({{0, 0, 0}, {8, 0, 0}}, masks);
  Displacement u = displaced(elements, [](const Vec3d& x) { return Vec3d(0, 0, 0.1 * x.x * x.y); });
  u.geometry = slice;
  const DeformationSummary summary = summarize(map_deformation(u, elements, {}), slice);
  ASSERT_TRUE(summary.bending_per_mm2);
  EXPECT_NEAR(*summary.bending_per_mm2, 2 * std::pow(0.1 / 6, 2), 1e-8);
}

TEST(UnitDeformationMetrics, AMaskLeavesTheDifferencesAndCountsLess) {
  const BrickTopology elements = block();
  const auto u = [](const Vec3d& x) { return Vec3d(0.01 * x.x * x.x, 0, 0); };
  const DeformationMaps maps = map_deformation(displaced(elements, u), elements, {});
  BrickValues mask(elements.brick_count());
  mask.set(elements.find({5, 5, 5}) * kBrickVoxels + brick_offset({5, 5, 5}), 3);
  const DeformationSummary one = summarize(maps, kScan, &mask);
  EXPECT_EQ(one.elements, 1);
  EXPECT_NEAR(one.min_jacobian, 1.1, 1e-5) << "central, beyond the mask";
  EXPECT_EQ(one.min_jacobian, one.max_jacobian);
}

TEST(UnitDeformationMetrics, VolumesTurnedInsideOutAreCountedAndLeftOutOfLogarithms) {
  // det F is 2 up to x = 5 and -0.5 beyond, 0.75 where both meet.
  const DeformationSummary summary =
      summary_of([](const Vec3d& x) { return Vec3d(x.x <= 5 ? x.x : 5 - 1.5 * (x.x - 5), 0, 0); });
  EXPECT_EQ(summary.nonpositive_jacobians, 4 * 81);
  const double mean = (4 * std::log(2) + std::log(0.75)) / 5;
  const double squares = (4 * std::pow(std::log(2), 2) + std::pow(std::log(0.75), 2)) / 5;
  EXPECT_NEAR(summary.sd_log_jacobian, std::sqrt(squares - mean * mean), 1e-5);
}

TEST(FaultDeformationMetrics, AValueThatIsNotFiniteIsAnError) {
  EXPECT_THROW(summary_of([](const Vec3d& x) { return Vec3d(x.x == 4 ? NAN : 0, 0, 0); }),
               InputError);
}

}  // namespace
}  // namespace supple::test
