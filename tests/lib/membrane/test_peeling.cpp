// A strip that is peeled off a plane at 90 degrees: the grip goes up as fast as the front goes on.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/lib/membrane/sheets.h"

namespace supple::test {

namespace {

constexpr double kCellMm = 0.2;
constexpr int kRows = 36, kWidthCells = 3;

MembraneParams peel_params() {
  MembraneParams params;
  // Links reach over five rows, and the lifted strip stretches by less than 1 % of their reach.
  params.stiffness_n_m = 20;
  params.damping_per_s = 0;
  params.adhesion_j_m2 = 0.05;
  params.adhesion_mm = 1;
  params.friction = 0;
  params.strength_n_m = 0;
  params.sweeps = 40;
  return params;
}

struct Peel {
  Vec3d force_n{0, 0, 0};   // mean over the rows
  double rows = 0;          // freed meanwhile
  std::vector<int> fronts;  // rows that are free, after every step
  int returned = 0;         // links that came back
};

/// Rows whose nodes all have let go, from the gripped one on.
int free_rows(const Membrane& membrane) {
  const std::vector<char>& clings = membrane.clings();
  int row = 0;
  for (; row <= kRows; ++row) {
    for (int j = 0; j <= kWidthCells; ++j) {
      if (clings[std::size_t(row * (kWidthCells + 1) + j)]) return row;
    }
  }
  return row;
}

/// Peels until the grip is `last` rows high, at a speed of 0.5 mm/s; means are from `first` rows
/// on.
Peel peel(const MembraneParams& params, int first, int last, double step_s = 0.02) {
  Membrane membrane(flat_sheet(kRows, kWidthCells, kCellMm), params, {plane_ground()}, "strip");
  const Instrument forceps = ball_forceps(1);
  const double width_mm = kWidthCells * kCellMm, step_mm = 0.5 * step_s;
  const Vec3d start(-0.93, width_mm / 2, params.thickness_mm);
  InstrumentPose pose = pose_at(start, 10);
  InstrumentPose closed = pose_at(start, 0);
  membrane.step(step_s, motion(forceps, pose, closed), {forceps});
  pose = closed;
  Peel peel;
  int steps = 0;
  double lean = 0;
  double free_at_first = 0;
  std::vector<char> before = membrane.clings();
  while (pose.tip_mm.z < last * kCellMm) {
    // The grip stays above the front: it goes on as far as the strip does not lean ahead.
    InstrumentPose next = pose;
    next.tip_mm += Vec3d(step_mm * (1 + lean), 0, step_mm);
    const MembraneReport report = membrane.step(step_s, motion(forceps, pose, next), {forceps});
    pose = next;
    const Vec3d& force_n = report.tool_forces_n[0];
    lean = std::clamp(-10 * force_n.x / force_n.z, -1.0, 1.0);
    peel.fronts.push_back(free_rows(membrane));
    for (std::size_t n = 0; n < before.size(); ++n)
      peel.returned += membrane.clings()[n] > before[n];
    before = membrane.clings();
    if (pose.tip_mm.z < first * kCellMm) {
      free_at_first = membrane.clinging_mm2();
      continue;
    }
    peel.force_n += force_n;
    ++steps;
  }
  peel.force_n /= double(steps);
  peel.rows = (free_at_first - membrane.clinging_mm2()) / (width_mm * kCellMm);
  return peel;
}

const Peel& usual_peel() {
  static const Peel usual = peel(peel_params(), 9, 30);
  return usual;
}

double energy_per_way_n(const MembraneParams& params) {
  return params.adhesion_j_m2 * kWidthCells * kCellMm * 1e-3;
}

}  // namespace

TEST(ConvergencePeeling, MeanForceAtNinetyDegreesIsEnergyPerAreaTimesWidth) {
  const MembraneParams params = peel_params();
  const Peel& peeled = usual_peel();
  EXPECT_GE(peeled.rows, 20);
  EXPECT_NEAR(-peeled.force_n.z, energy_per_way_n(params), 0.05 * energy_per_way_n(params));
  EXPECT_LT(std::abs(peeled.force_n.x), 0.05 * energy_per_way_n(params));
}

TEST(ConvergencePeeling, MeanForceIsTheSameAtHalfTheSubstepAndAtHalfTheStep) {
  MembraneParams params = peel_params();
  const double whole = -usual_peel().force_n.z;
  EXPECT_NEAR(-peel(params, 9, 30, 0.01).force_n.z, whole, 0.01 * whole);
  params.substep_s /= 2;
  EXPECT_NEAR(-peel(params, 9, 30).force_n.z, whole, 0.05 * whole);
}

TEST(ConvergencePeeling, MeanForceHasConvergedInSweeps) {
  MembraneParams params = peel_params();
  const double whole = -usual_peel().force_n.z;
  params.sweeps /= 2;
  EXPECT_NEAR(-peel(params, 9, 30).force_n.z, whole, 0.01 * whole);
}

TEST(UnitPeeling, ASheetThatIsLiftedEvenlyTakesTheForceAndTheEnergyOfItsAdhesion) {
  MembraneParams params;
  const int cells = 4;
  Membrane membrane(flat_sheet(cells, cells, kCellMm), params, {plane_ground()}, "sheet");
  const Instrument forceps = ball_forceps(2);
  InstrumentPose pose = pose_at({0.4, 0.4, params.thickness_mm}, 10);
  const double area_m2 = std::pow(cells * kCellMm * 1e-3, 2), step_mm = 0.0005;
  double most_n = 0, work_j = 0;
  while (membrane.clinging_mm2() > 0) {
    InstrumentPose next = pose;
    next.opening_degrees = 0;
    next.tip_mm.z += step_mm;
    const double force_n =
        -membrane.step(params.substep_s, motion(forceps, pose, next), {forceps}).tool_forces_n[0].z;
    pose = next;
    most_n = std::max(most_n, force_n);
    work_j += force_n * step_mm * 1e-3;
    ASSERT_LT(pose.tip_mm.z, 1);
  }
  const double limit_n = 2 * params.adhesion_j_m2 * area_m2 / (params.adhesion_mm * 1e-3);
  EXPECT_NEAR(most_n, limit_n, 0.02 * limit_n);
  EXPECT_NEAR(work_j, params.adhesion_j_m2 * area_m2, 0.03 * work_j);
}

TEST(PropertyPeeling, LinksBreakWhereTheyReachTheirForceAndNowhereElse) {
  MembraneParams params = peel_params();
  params.adhesion_mm = 0.3;
  Membrane membrane(flat_sheet(12, kWidthCells, kCellMm), params, {plane_ground()}, "strip");
  const Instrument forceps = ball_forceps(1);
  InstrumentPose pose = pose_at({-0.93, 0.3, params.thickness_mm}, 10);
  std::int64_t broken = 0;
  for (int n = 0; n < 1500; ++n) {
    InstrumentPose next = pose;
    next.opening_degrees = 0;
    next.tip_mm += Vec3d(0.001, 0, 0.001);
    const std::vector<char> clung = membrane.clings();
    broken += count_of(membrane.step(params.substep_s, motion(forceps, pose, next), {forceps}),
                       MembraneEvent::Kind::link_broken);
    pose = next;
    const MeshBody& body = membrane.body();
    for (std::size_t node = 0; node < clung.size(); ++node) {
      const double stretch = (body.pos_mm[node] - body.rest_mm[node]).length();
      if (membrane.clings()[node]) {
        ASSERT_LT(stretch, 1.01 * params.adhesion_mm) << n;
      } else if (clung[node]) {
        ASSERT_GT(stretch, 0.99 * params.adhesion_mm) << n;
      }
    }
  }
  EXPECT_GT(broken, 20);
}

TEST(PropertyPeeling, FrontsOnlyGoOnAndLinksOnlyBreak) {
  MembraneParams params = peel_params();
  for (const int sweeps : {2, 20}) {
    params.sweeps = sweeps;
    const Peel peeled = peel(params, 6, 24);
    EXPECT_EQ(peeled.returned, 0);
    EXPECT_GT(peeled.fronts.back(), 15) << sweeps;
    for (std::size_t n = 1; n < peeled.fronts.size(); ++n) {
      EXPECT_GE(peeled.fronts[n], peeled.fronts[n - 1]);
    }
  }
}

}  // namespace supple::test
