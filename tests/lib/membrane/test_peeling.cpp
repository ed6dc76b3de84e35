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

/// Peels until the grip is `last` rows high; means are from `first` rows on.
Peel peel(const MembraneParams& params, int first, int last) {
  Membrane membrane(flat_sheet(kRows, kWidthCells, kCellMm), params, {plane_ground()}, "strip");
  const Instrument forceps = ball_forceps(1);
  const double width_mm = kWidthCells * kCellMm, step_mm = 0.01;
  const Vec3d start(-0.93, width_mm / 2, params.thickness_mm);
  InstrumentPose pose = pose_at(start, 10);
  InstrumentPose closed = pose_at(start, 0);
  membrane.step(0.02, motion(forceps, pose, closed), {forceps});
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
    const MembraneReport report = membrane.step(0.02, motion(forceps, pose, next), {forceps});
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

double energy_per_way_n(const MembraneParams& params) {
  return params.adhesion_j_m2 * kWidthCells * kCellMm * 1e-3;
}

}  // namespace

TEST(ConvergencePeeling, MeanForceAtNinetyDegreesIsEnergyPerAreaTimesWidth) {
  const MembraneParams params = peel_params();
  const Peel peeled = peel(params, 9, 30);
  EXPECT_GE(peeled.rows, 20);
  EXPECT_NEAR(-peeled.force_n.z, energy_per_way_n(params), 0.05 * energy_per_way_n(params));
  EXPECT_LT(std::abs(peeled.force_n.x), 0.05 * energy_per_way_n(params));
}

TEST(ConvergencePeeling, MeanForceIsTheSameAtHalfTheSubstep) {
  MembraneParams params = peel_params();
  const double whole = -peel(params, 9, 30).force_n.z;
  params.substep_s /= 2;
  const double half = -peel(params, 9, 30).force_n.z;
  EXPECT_NEAR(half, whole, 0.05 * whole);
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
