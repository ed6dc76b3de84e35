// Warps through landmarks (landmark_map.h): splines, rigid labels, and folds on a grid.
#include <random>

#include <gtest/gtest.h>

#include "tests/support/errors.h"
#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/field/landmarks/grid_folds.h"
#include "volumes/field/landmarks/point_spline.h"
#include "volumes/field/landmarks/unfolded_map.h"

using namespace supple;
using namespace supple::test;

namespace {

const Geometry kGrid({30, 26, 22}, {-20, 4, 7}, {Vec3d(0, 2, 0), {-1.5, 0, 0.2}, {0, 0, 2.5}});

Landmarks random_landmarks(int count, double length_mm, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> part(0, 1), way(-length_mm, length_mm);
  Landmarks landmarks;
  for (int n = 0; n < count; ++n) {
    landmarks.points.push_back(
        kGrid.world_from_index({29 * part(random), 25 * part(random), 21 * part(random)}));
    landmarks.vectors.push_back({way(random), way(random), way(random)});
  }
  return landmarks;
}

double length_of_difference(const Vec3d& a, const Vec3d& b) {
  return (a - b).length();
}

/// Label 1 in a ball, label 2 in a slab.
RegionLabels ball_and_slab() {
  return {kGrid, [](const Vec3i& voxel) {
            if (Vec3d(voxel - Vec3i(9, 9, 9)).length() < 5) return 1;
            return voxel.x > 22 ? 2 : 0;
          }};
}

/// Five landmarks in each of the two, moved rigidly, and some outside.
Landmarks bones_and_others(const Turn& turn, const Vec3d& shift) {
  Landmarks landmarks = random_landmarks(12, 2, 7);
  for (std::size_t n = 0; n < landmarks.points.size(); ++n) {
    landmarks.points[n] = kGrid.world_from_index({17.0 + double(n % 3), 2.0 * double(n), 19});
  }
  for (const Vec3i& voxel : {Vec3i(9, 9, 9), {11, 8, 9}, {8, 12, 10}, {7, 9, 6}, {10, 7, 11}}) {
    const Vec3d place = kGrid.world_from_index(Vec3d(voxel));
    landmarks.points.push_back(place);
    landmarks.vectors.push_back(turn.way_of(place) + shift);
  }
  for (const Vec3i& voxel : {Vec3i(25, 3, 4), {27, 20, 5}, {24, 10, 18}}) {
    landmarks.points.push_back(kGrid.world_from_index(Vec3d(voxel)));
    landmarks.vectors.push_back(Vec3d(0.5, 0, -1));
  }
  return landmarks;
}

std::shared_ptr<const RigidRegions> regions_of(const Landmarks& landmarks,
                                               const std::vector<std::int32_t>& rigid) {
  return std::make_shared<RigidRegions>(ball_and_slab(), rigid, landmarks.points, landmarks.vectors,
                                        10);
}

}  // namespace

TEST(UnitPointSpline, MeetsItsPointsAndKeepsAffineFields) {
  const Landmarks some = random_landmarks(40, 8, 1);
  const SplineSum spline = fit_spline(some.points, some.vectors);
  double worst = 0;
  for (std::size_t n = 0; n < 40; ++n) {
    worst = std::max(worst, length_of_difference(spline.at(some.points[n]), some.vectors[n]));
  }
  EXPECT_LT(worst, 1e-10);

  const auto affine = [](const Vec3d& x) {
    return Vec3d(1 + 0.1 * x.x - 0.3 * x.z, 0.2 * x.y, -2 + 0.05 * x.x);
  };
  std::vector<Vec3d> vectors;
  for (const Vec3d& point : some.points) vectors.push_back(affine(point));
  for (const double stiffness : {0.0, 3.0, 1e4}) {
    const SplineSum of_affine = fit_spline(some.points, vectors, stiffness);
    const Vec3d far(300, -200, 150);
    EXPECT_LT(length_of_difference(of_affine.at(far), affine(far)), 1e-8) << stiffness;
  }
}

TEST(UnitPointSpline, IsAStationaryPointOfItsEnergy) {
  // The energy of a sum of -w |x - c| without moments is -8 pi w K w; with the normal equations its
  // minimum has d_i - v(x_i) = stiffness * w_i for every point.
  const Landmarks some = random_landmarks(25, 5, 2);
  const double stiffness = 4;
  const SplineSum spline = fit_spline(some.points, some.vectors, stiffness);
  Vec3d sum(0);
  std::array<Vec3d, 3> moments{Vec3d(0), Vec3d(0), Vec3d(0)};
  double missed = 0;
  for (std::size_t n = 0; n < some.points.size(); ++n) {
    const Vec3d weight = (some.vectors[n] - spline.at(some.points[n])) / stiffness;
    missed = std::max(missed, weight.length());
    sum += weight;
    for (int a = 0; a < 3; ++a) moments[std::size_t(a)] += weight * some.points[n][a];
  }
  EXPECT_GT(missed, 0.01);
  EXPECT_LT(sum.length(), 1e-10);
  for (const Vec3d& moment : moments) EXPECT_LT(moment.length(), 1e-8);

  // The field is affine once these weights are taken out.
  const auto rest = [&](const Vec3d& x) {
    Vec3d vector = spline.at(x);
    for (std::size_t n = 0; n < some.points.size(); ++n) {
      const Vec3d weight = (some.vectors[n] - spline.at(some.points[n])) / stiffness;
      vector += weight * (x - some.points[n]).length();
    }
    return vector;
  };
  const Vec3d a(3, -8, 20), b(-31, 44, 5), c(12, 2, 60);
  EXPECT_LT(length_of_difference(rest((a + b + c) / 3), (rest(a) + rest(b) + rest(c)) / 3), 1e-9);
}

TEST(ExtremesPointSpline, FewPointsAndThoseOfAPlaneAreEnough) {
  const std::vector<Vec3d> line{{1, 2, 3}, {2, 4, 6}, {4, 8, 12}};
  const std::vector<Vec3d> vectors{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const std::size_t count : {1, 2, 3}) {
    const SplineSum spline = fit_spline({line.begin(), line.begin() + long(count)},
                                        {vectors.begin(), vectors.begin() + long(count)});
    for (std::size_t n = 0; n < count; ++n) {
      EXPECT_LT(length_of_difference(spline.at(line[n]), vectors[n]), 1e-12) << count;
    }
    const Vec3d across = Vec3d(2, -1, 0);
    EXPECT_LT(spline.at(line[0] + across * 10).length(), 40) << count;
    if (count > 1) continue;
    EXPECT_LT(length_of_difference(spline.at({90, 0, 9}), vectors[0]), 1e-12);
  }
  // A plane but for rounding, of the points and of a file; and what is seen of it far across.
  const Vec3d normal = Vec3d(1, 2, -3) / std::sqrt(14.0), middle(1, 1, 1);
  for (const double rough_mm : {0.0, 1e-12, 1e-10}) {
    Landmarks flat = random_landmarks(12, 3, 8);
    for (std::size_t n = 0; n < 12; ++n) {
      Vec3d& point = flat.points[n];
      point += normal * (rough_mm * std::sin(double(n)) - normal.dot(point - middle));
    }
    const SplineSum spline = fit_spline(flat.points, flat.vectors);
    EXPECT_LT(spline.at(middle + normal * 200).length(), 40) << rough_mm;
    for (std::size_t n = 0; n < 12; ++n) {
      EXPECT_LT(length_of_difference(spline.at(flat.points[n]), flat.vectors[n]), 1e-6) << rough_mm;
    }
  }

  const auto twice = [&](double stiffness) {
    return fit_spline({line[0], line[1], line[0]}, vectors, stiffness);
  };
  EXPECT_EQ(input_error([&] { twice(0); }),
            "points: found number 3 at the place of number 1, expected another place, or a "
            "stiffness above 0");
  EXPECT_LT(length_of_difference(twice(1e-6).at(line[0]), {0.5, 0, 0.5}), 1e-4);
}

TEST(UnitSplineSum, RowsAreThePointsOnTheirPlaces) {
  const Landmarks some = random_landmarks(9, 3, 5);
  const SplineSum spline = fit_spline(some.points, some.vectors);
  std::vector<Vec3d> row(75);
  const Vec3d first(-3, 8, 2), step(0.3, 0.7, -0.2);
  spline.row(first, step, 75, row.data());
  for (int n = 0; n < 75; ++n) {
    EXPECT_LT(length_of_difference(row[std::size_t(n)], spline.at(first + step * double(n))),
              1e-12);
  }
}

TEST(UnitRigidRegions, LabelsMoveRigidlyAndTheRestMeetsItsPoints) {
  const Turn turn = turn_about({1, 2, -1}, 12);
  const Vec3d shift(3, -2, 1);
  const Landmarks landmarks = bones_and_others(turn, shift);
  const auto regions = regions_of(landmarks, {1, 2});
  EXPECT_LT(regions->largest_misfit_mm(), 1e-10);
  EXPECT_EQ(regions->outside().size(), 12u);
  const LandmarkMap map(landmarks, regions, 0);
  EXPECT_LT(map.misfit().largest_mm, 1e-9);

  std::vector<Vec3f> slice(30 * 26);
  const VectorSliceSource slices = map.slices(kGrid);
  double worst = 0, jump = 0;
  const RegionLabels labels = ball_and_slab();
  for (int k = 0; k < 22; ++k) {
    slices(k, slice.data());
    for (int j = 0; j < 26; ++j) {
      for (int i = 0; i < 30; ++i) {
        const Vec3d place = kGrid.world_from_index(Vec3d(i, j, k));
        const Vec3d vector(slice[std::size_t(j) * 30 + std::size_t(i)]);
        const int label = labels.at({i, j, k});
        if (label == 1) {
          worst = std::max(worst, length_of_difference(vector, turn.way_of(place) + shift));
        } else if (label == 2) {
          worst = std::max(worst, length_of_difference(vector, {0.5, 0, -1}));
        }
        if (i > 0) {
          const Vec3d before(slice[std::size_t(j) * 30 + std::size_t(i) - 1]);
          jump = std::max(jump, length_of_difference(vector, before));
        }
      }
    }
  }
  EXPECT_LT(worst, 1e-5);
  EXPECT_LT(jump, 6) << "no step at the border of a label";
}

TEST(UnitRigidRegions, WhereAllLabelsMoveAlikeSoDoesEverythingElse) {
  Landmarks landmarks = bones_and_others({}, {3, -2, 1});
  landmarks.points.erase(landmarks.points.begin(), landmarks.points.begin() + 12);
  landmarks.vectors.assign(landmarks.points.size(), Vec3d(3, -2, 1));
  const LandmarkMap map(landmarks, regions_of(landmarks, {1, 2}), 0);
  for (const Vec3d& index : {Vec3d(0, 0, 0), {16.3, 9.1, 8.8}, {29, 25, 21}, {60, -20, 11}}) {
    EXPECT_LT(length_of_difference(map.at(kGrid.world_from_index(index)), {3, -2, 1}), 1e-12);
  }
}

TEST(FaultRigidRegions, LabelsWithoutVoxelsOrLandmarksAreRefused) {
  const auto line = [](const std::vector<std::int32_t>& rigid, const std::vector<Vec3d>& points) {
    return input_error([&] {
      RigidRegions(ball_and_slab(), rigid, points, std::vector<Vec3d>(points.size()), 10);
    });
  };
  const auto at = [](int x) { return kGrid.world_from_index(Vec3d(x, 9, 9)); };
  EXPECT_EQ(line({7}, {at(8)}),
            "rigid: found no voxel of label 7, expected a label of the label volume");
  EXPECT_EQ(line({1}, {at(8), at(9)}),
            "landmarks in label 1: found 2, expected at least 3, not on a line");
  EXPECT_EQ(line({1}, {at(8), at(9), at(10)}),
            "landmarks in label 1: found all on a line, expected at least 3, not on a line");
}

TEST(UnitGridFolds, CountsCellsThatTurnOver) {
  const auto count = [](const std::function<Vec3d(const Vec3i&)>& index_vector) {
    GridFolds folds(kGrid);
    std::vector<Vec3f> slice(30 * 26);
    for (int k = 0; k < 22; ++k) {
      for (int n = 0; n < 30 * 26; ++n) {
        slice[std::size_t(n)] =
            Vec3f(kGrid.world_vector_from_index(index_vector({n % 30, n / 30, k})));
      }
      folds.add(k, slice.data());
    }
    return folds;
  };
  const GridFolds rest = count([](const Vec3i&) { return Vec3d(0); });
  EXPECT_EQ(rest.folded_cells(), 0);
  EXPECT_NEAR(rest.smallest_det(), 1, 1e-5);
  const GridFolds halved = count([](const Vec3i& v) { return Vec3d(-0.5 * v.x, 0, 0); });
  EXPECT_EQ(halved.folded_cells(), 0);
  EXPECT_NEAR(halved.smallest_det(), 0.5, 1e-5);
  const GridFolds one =
      count([](const Vec3i& v) { return v == Vec3i(12, 9, 8) ? Vec3d(1.2, 0, 0) : Vec3d(0); });
  EXPECT_EQ(one.folded_cells(), 4) << "beyond the node along x";
  EXPECT_NEAR(one.smallest_det(), -0.2, 1e-5);
}

TEST(PropertyLandmarkMap, FoldsEndAtTheLeastStiffness) {
  const Landmarks wild = random_landmarks(20, 9, 11);
  const auto folded = [&](double stiffness) {
    const LandmarkMap map(wild, nullptr, stiffness);
    GridFolds folds(kGrid);
    const VectorSliceSource slices = counted(map.slices(kGrid), folds);
    std::vector<Vec3f> slice(30 * 26);
    for (int k = 0; k < 22; ++k) slices(k, slice.data());
    return folds.folded_cells();
  };
  ASSERT_GT(folded(0), 0);
  const UnfoldedMap found = without_folds(wild, nullptr, 0, kGrid, nullptr);
  EXPECT_GT(found.stiffness_mm, 0);
  EXPECT_EQ(folded(found.stiffness_mm), 0);
  EXPECT_GT(folded(found.stiffness_mm / 1.1), 0);
  const UnfoldedMap as_asked = without_folds(wild, nullptr, 2 * found.stiffness_mm, kGrid, nullptr);
  EXPECT_EQ(as_asked.stiffness_mm, 2 * found.stiffness_mm);
}

TEST(FaultLandmarkMap, AMirrorFoldsAtAnyStiffness) {
  Landmarks mirror = random_landmarks(8, 0, 3);
  for (std::size_t n = 0; n < 8; ++n) mirror.vectors[n] = Vec3d(-2 * mirror.points[n].x, 0, 0);
  EXPECT_NE(input_error([&] {
              without_folds(mirror, nullptr, 0, kGrid, nullptr);
            }).find("folded cells at any stiffness"),
            std::string::npos);
}

TEST(PropertyLandmarkMap, AnyNumberOfThreadsGivesTheSameBits) {
  const Landmarks landmarks = bones_and_others(turn_about({0, 0, 1}, 5), {1, 1, 0});
  const LandmarkMap map(landmarks, regions_of(landmarks, {1}), 0.5);
  const auto all = [&](int threads) {
    return on_threads(threads, [&] {
      std::vector<Vec3f> field(std::size_t(kGrid.voxel_count()));
      for (int k = 0; k < 22; ++k) map.slices(kGrid)(k, &field[std::size_t(k) * 30 * 26]);
      return field;
    });
  };
  EXPECT_EQ(all(1), all(5));
}
