// Tissue that swells in a closed shell, and in one with an opening: what grows comes out, and what
// cannot grow is pressed, by -K dV/V (thesis section 6.2).
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "lib/fem/voxel/fem_loads.h"
#include "lib/fem/voxel/fem_results.h"
#include "tests/lib/fem_fixtures.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr int kHeadSize = 16;
constexpr double kBrainYoungKpa = 6, kBrainPoisson = 0.4, kSwellingKpa = 0.6;
constexpr double kBulkKpa = kBrainYoungKpa / (3 * (1 - 2 * kBrainPoisson));
constexpr int kBrain = 0, kSkull = 1;

/// A ball of tissue of 2 mm voxels in a shell, of which a cap of so many degrees is left out.
Body head(double cap_deg) {
  return fem_body(
      kHeadSize,
      [=](const Vec3i& v) {
        const Vec3d x = Vec3d(v) - Vec3d((kHeadSize - 1) / 2.0);
        const double r = x.length();
        if (r < 6) return kBrain;
        if (r > 7.9 || x.z > r * std::cos(cap_deg * kRadiansPerDegree)) return -1;
        return kSkull;
      },
      2);
}

SlotSet elements_of_class(const Body& body, int of) {
  std::vector<Slot> slots;
  for_each_element(body.elements, [&](Slot slot) {
    if (body.classes[slot] == of) slots.push_back(slot);
  });
  return SlotSet(std::move(slots));
}

FemLoads swollen(const Body& body, double kpa = kSwellingKpa) {
  FemLoads loads;
  loads.held.emplace_back().elements = elements_of_class(body, kSkull);
  loads.inner_pressures.push_back({elements_of_class(body, kBrain), kpa});
  return loads;
}

FemParams exact(StrainTheory theory) {
  FemParams params;
  params.strain = theory;
  params.tolerance = 1e-9;
  return params;
}

/// Corners of the six faces of a hexahedron in turn, outwards in a right-handed grid.
constexpr int kFaces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                              {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};

double six_volumes(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return a.dot(b.cross(c));
}

/// The volume between a bilinear patch and the origin: the mean of those of both its folds.
double volume_of(const std::array<Vec3d, 4>& x) {
  return (six_volumes(x[0], x[1], x[2]) + six_volumes(x[0], x[2], x[3]) +
          six_volumes(x[1], x[2], x[3]) + six_volumes(x[1], x[3], x[0])) /
         12;
}

/// The volume that the tissue's surface encloses more than at rest, mm3: by the displacement, and
/// of its slope at rest. No element inside counts.
struct Enclosed {
  double change = 0, slope = 0;
};
Enclosed enclosed(const FemModel& model, const std::vector<double>& u_mm) {
  const std::vector<Vec3d> rest = model.node_positions();
  std::map<std::array<NodeIndex, 4>, std::array<NodeIndex, 4>> outside;
  for (std::int32_t e = 0; e < model.mesh().element_count(); ++e) {
    const Corners corners = model.mesh().corners(e);
    for (const auto& of : kFaces) {
      std::array<NodeIndex, 4> face{}, key{};
      for (std::size_t n = 0; n < 4; ++n) face[n] = corners[std::size_t(of[n])];
      key = face;
      std::sort(key.begin(), key.end());
      if (!outside.emplace(key, face).second) outside.erase(key);
    }
  }
  const auto volume = [&](double scale) {
    double sum = 0;
    for (const auto& [key, face] : outside) {
      std::array<Vec3d, 4> x;
      for (std::size_t n = 0; n < 4; ++n) {
        const double* u = &u_mm[3 * std::size_t(face[n])];
        x[n] = rest[std::size_t(face[n])] + Vec3d(u[0], u[1], u[2]) * scale;
      }
      sum += volume_of(x);
    }
    return std::abs(sum);
  };
  // A cubic of the scale, whose central difference is off by its own third order alone.
  constexpr double kStep = 1e-3;
  return {volume(1) - volume(0), (volume(kStep) - volume(-kStep)) / (2 * kStep)};
}

double mean_pressure(const FemModel& model, const FemSolution& solution, StrainTheory theory,
                     const Body& body) {
  const std::vector<float> pressure =
      element_values(model.mesh(), model.material(), solution.u_mm, FemQuantity::pressure, theory,
                     solution.swelling_kpa);
  double sum = 0;
  std::size_t element = 0, count = 0;
  for_each_element(body.elements, [&](Slot slot) {
    if (body.classes[slot] == kBrain) sum += double(pressure[element]), ++count;
    ++element;
  });
  return sum / double(count);
}

}  // namespace

TEST(PropertyFemSwelling, WhatIsFreeGrowsAndInAClosedShellIsPressedByAsMuch) {
  // A cube on three planes without friction grows alike everywhere.
  const Body cube = fem_cube(4);
  FemLoads loads;
  for (int a = 0; a < 3; ++a) {
    loads.held.push_back(hold_where(cube, [a](const Vec3d& x) { return x[a] < -0.49; }));
    loads.held.back().axes = {a == 0, a == 1, a == 2};
  }
  loads.inner_pressures.push_back({elements_in(cube, {{0, 0, 0}, {4, 4, 4}}), kSwellingKpa});
  const ElasticTable elastic = ElasticTable::uniform(kBrainYoungKpa, kBrainPoisson);
  const FemModel alone(cube, elastic);
  const FemSolution grown = alone.solve(loads, exact(StrainTheory::linear));
  const double growth = grown.report.volume_change_ml / (64 * kMlPerMm3);
  EXPECT_NEAR(growth, kSwellingKpa / kBulkKpa, 1e-8);
  EXPECT_NEAR(mean_pressure(alone, grown, StrainTheory::linear, cube), 0, 1e-7);

  const Body closed = head(0);
  const FemModel model(closed, elastic);
  for (const StrainTheory theory : {StrainTheory::linear, StrainTheory::finite}) {
    const FemSolution solution = model.solve(swollen(closed), exact(theory));
    for (const double u : solution.u_mm) ASSERT_NEAR(u, 0, 1e-12);
    EXPECT_NEAR(solution.report.volume_change_ml, 0, 1e-12);
    EXPECT_NEAR(mean_pressure(model, solution, theory, closed), kBulkKpa * growth, 1e-7);
  }
}

TEST(PropertyFemSwelling, WhatComesOutOfAnOpeningIsWhatTheTissueGrewBy) {
  for (const double cap_deg : {25.0, 50.0}) {
    const Body body = head(cap_deg);
    const FemModel model(body, ElasticTable::uniform(kBrainYoungKpa, kBrainPoisson));
    const double rest_ml = double(elements_of_class(body, kBrain).size()) * 8 * kMlPerMm3;

    const FemSolution linear = model.solve(swollen(body), exact(StrainTheory::linear));
    const double out_ml = enclosed(model, linear.u_mm).slope * kMlPerMm3;
    EXPECT_GT(out_ml, 0.001 * rest_ml);
    EXPECT_NEAR(linear.report.volume_change_ml, out_ml, 1e-5 * out_ml);
    // The swelling works on what grew: kPa times ml are mJ.
    EXPECT_NEAR(2 * linear.report.energy_mj, kSwellingKpa * out_ml, 1e-5 * kSwellingKpa * out_ml);
    // The pressure that is left: that of the thesis.
    EXPECT_NEAR(mean_pressure(model, linear, StrainTheory::linear, body),
                kSwellingKpa - kBulkKpa * out_ml / rest_ml, 1e-5);

    const FemSolution finite = model.solve(swollen(body), exact(StrainTheory::finite));
    const double finite_ml = enclosed(model, finite.u_mm).change * kMlPerMm3;
    EXPECT_NEAR(finite.report.volume_change_ml, finite_ml, 1e-8 * rest_ml);
    EXPECT_NEAR(finite_ml, out_ml, 0.2 * out_ml);
    EXPECT_GT(finite.report.smallest_det_f, 0);
    // The energy is that of the tissue, without the work of the swelling.
    EXPECT_NEAR(finite.report.energy_mj, linear.report.energy_mj, 0.2 * linear.report.energy_mj);
    EXPECT_LT(finite.report.energy_identity, 1e-6);
  }
}

TEST(PropertyFemSwelling, AtFiniteStrainAStrongSwellingGrowsInSteps) {
  // The whole of it at once is too much for a step, whatever part of the other loads that has.
  const Body body = head(60);
  const FemModel model(body, ElasticTable::uniform(kBrainYoungKpa, 0.48));
  const FemSolution solution = model.solve(swollen(body, 6), exact(StrainTheory::finite));
  ASSERT_TRUE(solution.report.newton);
  EXPECT_GT(solution.report.newton->load_steps, 1);
  EXPECT_EQ(solution.report.newton->load_part, 1);
  EXPECT_NEAR(solution.report.volume_change_ml, enclosed(model, solution.u_mm).change * kMlPerMm3,
              1e-6);

  // The way there makes no difference.
  FemLoads loads = swollen(body, 6);
  loads.inner_pressures.push_back(loads.inner_pressures.front());
  for (PressureInElements& half : loads.inner_pressures) half.pressure_kpa = 3;
  const FemSolution twice = model.solve(loads, exact(StrainTheory::finite));
  for (std::size_t n = 0; n < twice.u_mm.size(); ++n) {
    ASSERT_NEAR(twice.u_mm[n], solution.u_mm[n], 1e-9);
  }
}

TEST(PropertyFemSwelling, VolumesHaveTheSameBitsOnAnyNumberOfThreads) {
  std::mt19937 random(53);
  const FemModel model(fem_cube(24), ElasticTable::uniform(kBrainYoungKpa, kBrainPoisson));
  std::vector<double> u = random_values(random, 3 * std::size_t(model.mesh().node_count()));
  for (double& value : u) value *= 0.01;
  for (const StrainTheory theory : {StrainTheory::linear, StrainTheory::finite}) {
    const auto change = [&] {
      return volume_change_mm3(model.mesh(), model.material(), u, theory);
    };
    const double one = on_threads(1, change);
    for (int round = 0; round < 30; ++round) ASSERT_EQ(on_threads(5, change), one);
  }
}
