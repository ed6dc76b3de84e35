// Laws of a whole operation: what its parts have to do with each other.
#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "lib/instruments/track.h"
#include "lib/operation/operation.h"
#include "lib/operation/score.h"
#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {
namespace {

EyeSetup eye_with(const Vec3d& first, const Vec3d& second) {
  EyeSetup eye;
  eye.incisions = {{"first", first}, {"second", second}};
  return eye;
}

OperationTool tool(const std::string& name, InstrumentKind kind, const Vec3d& tip_mm,
                   const std::string& incision = "temporal") {
  OperationTool one;
  one.shape.name = name;
  one.shape.kind = kind;
  one.incision = incision;
  one.start.tip_mm = tip_mm;
  return one;
}

InstrumentPose toward(const Operation& operation, std::size_t n, const Vec3d& tip_mm) {
  InstrumentPose pose = operation.setup().tools[n].start;
  pose.tip_mm = tip_mm;
  const std::vector<Incision>& incisions = operation.setup().eye->incisions;
  for (const Incision& incision : incisions) {
    if (incision.name == operation.setup().tools[n].incision) {
      pose = through_pivot(pose, operation.turn().to_head(incision.place_mm));
    }
  }
  return pose;
}

OperationSetup needle_in_eye() {
  OperationSetup setup;
  setup.eye.emplace();
  setup.tools.push_back(tool("needle", InstrumentKind::needle, {0, 0, -5}));
  return setup;
}

int count_of(const OperationSample& sample, const std::string& kind) {
  return int(std::count_if(sample.events.begin(), sample.events.end(),
                           [&](const OperationEvent& event) { return event.kind == kind; }));
}

TEST(UnitEye, StaysAtRestWhileShaftsGoThroughItsIncisions) {
  const EyeSetup eye = eye_with({11, 0, 0}, {0, 11, 0});
  const std::vector<Shaft> shafts = {{{0, 0, -5}, Vec3d(11, 0, 5).normalized(), {11, 0, 0}}};
  EXPECT_LT(next_turn(eye, {}, shafts, 10).vector.length(), 1e-12);
}

TEST(UnitEye, TurnsSoFarThatMusclesAndIncisionAreInBalance) {
  // A shaft along x, shifted by d along y at an incision at (r, 0, 0): the eye turns about z by w.
  // Without a component along the shaft the wall is stretched by d - r sin w, so that
  //   muscles w = wall (d - r sin w) r cos w.
  EyeSetup eye = eye_with({11, 0, 0}, {0, 11, 0});
  eye.wall_n_per_mm = 0.05;
  const std::vector<Shaft> shafts = {{{0, 1, 0}, {1, 0, 0}, {11, 0, 0}}};
  const Vec3d w = next_turn(eye, {}, shafts, 1e6).vector;
  EXPECT_NEAR(w.x, 0, 1e-9);
  EXPECT_NEAR(w.y, 0, 1e-9);
  EXPECT_GT(w.z, 0.01);
  EXPECT_NEAR(eye.muscles_n_mm_per_rad * w.z,
              eye.wall_n_per_mm * (1 - 11 * std::sin(w.z)) * 11 * std::cos(w.z), 1e-9);
}

TEST(UnitEye, GoesBackToRestWithoutShaftsAtItsOwnPace) {
  EyeSetup eye;
  EyeTurn turn{{0.1, -0.2, 0.3}};
  turn = next_turn(eye, turn, {}, eye.settles_s);
  EXPECT_NEAR(turn.vector.x, 0.1 * std::exp(-1), 1e-12);
  EXPECT_NEAR(turn.vector.z, 0.3 * std::exp(-1), 1e-12);
}

TEST(UnitEye, TurnsThereAndBackLeadToTheSamePlace) {
  const EyeTurn turn{{0.4, -0.3, 0.9}};
  const Vec3d place(3, -7, 2);
  EXPECT_LT((turn.to_eye(turn.to_head(place)) - place).length(), 1e-12);
  EXPECT_NEAR(turn.to_head(place).length(), place.length(), 1e-12);
}

TEST(UnitOperation, TipsStopAtTheRetinaAndBleedOnce) {
  Operation operation(needle_in_eye());
  int bleedings = 0, touches = 0;
  for (int n = 1; n <= 40; ++n) {
    const OperationSample& sample = operation.step({toward(operation, 0, {0, 0, -5 - 0.25 * n})});
    bleedings += count_of(sample, "bleeding");
    touches += count_of(sample, "touch");
    EXPECT_LE(sample.instruments[0].pose.tip_mm.length(), 11 + 1e-6);
  }
  EXPECT_EQ(bleedings, 1);
  EXPECT_GT(touches, 5);
  ASSERT_EQ(operation.bleedings().size(), 1u);
  EXPECT_GT(operation.bleedings()[0].radius_mm, 0.05);
  EXPECT_LT((operation.bleedings()[0].place_mm - Vec3d(0, 0, -11)).length(), 1.0);
}

TEST(UnitOperation, ForceOfATouchIsDepthTimesStiffness) {
  Operation operation(needle_in_eye());
  operation.step({toward(operation, 0, {0, 0, -10})});
  const OperationSample& sample = operation.step({toward(operation, 0, {0, 0, -11.5})});
  const double stiffness_n_mm = operation.instruments()[0].stiffness_n_m * kMPerMm;
  EXPECT_NEAR(sample.instruments[0].force_n, 0.5 * stiffness_n_mm, 0.1 * stiffness_n_mm);
}

TEST(UnitOperation, AnInstrumentThatStartsWithinTheRetinaIsRefused) {
  OperationSetup setup = needle_in_eye();
  setup.tools[0].start.tip_mm = {0, 0, -12};
  EXPECT_THROW(Operation{setup}, InputError);
}

TEST(UnitOperation, AnIncisionThatTheEyeLacksIsRefused) {
  OperationSetup setup = needle_in_eye();
  setup.tools[0].incision = "superior";
  EXPECT_THROW(Operation{setup}, InputError);
}

TEST(FaultOperation, PosesThatAreNotFiniteOrTooFewAreRefusedAndNothingMoves) {
  Operation operation(needle_in_eye());
  operation.step({toward(operation, 0, {0, 0, -6})});
  const std::string before = operation.digest();
  InstrumentPose pose = toward(operation, 0, {0, 0, -7});
  EXPECT_THROW(operation.step({}), InputError);
  for (double* number : {&pose.tip_mm.x, &pose.axis.z, &pose.roll_degrees, &pose.active}) {
    const double kept = std::exchange(*number, std::nan(""));
    EXPECT_THROW(operation.step({pose}), InputError);
    *number = kept;
  }
  pose.axis = Vec3d(0.0);
  EXPECT_THROW(operation.step({pose}), InputError);
  EXPECT_EQ(operation.digest(), before);
}

TEST(UnitOperation, AnotherModelTakesAMembraneOverAtItsTime) {
  OperationSetup setup = needle_in_eye();
  setup.tools[0].shape.kind = InstrumentKind::forceps;
  OperationMembrane membrane;
  membrane.name = "membrane";
  membrane.mesh = membrane_on_sphere({0, 0, 0}, 10.98, {0, 0, -1}, 2, 100);
  setup.membranes.push_back(membrane);
  const auto digests = [&](const std::vector<ModelChange>& changes) {
    setup.membranes[0].changes = changes;
    Operation operation(setup);
    std::vector<std::string> all;
    for (int n = 1; n <= 30; ++n) {
      operation.step({toward(operation, 0, {0, 0, -5 - 0.21 * n})});
      all.push_back(operation.digest());
    }
    return all;
  };
  const std::vector<std::string> springs = digests({}),
                                 changed = digests({{0.57, MembraneModel::ecm}});
  EXPECT_EQ(springs[27], changed[27]);  // at 0.56 s
  EXPECT_NE(springs[28], changed[28]);
}

TEST(FaultOperation, AStepThatIsNoWholeNumberOfSubstepsIsRefusedAtOnce) {
  OperationSetup setup = needle_in_eye();
  OperationMembrane membrane;
  membrane.name = "membrane";
  membrane.mesh = membrane_on_sphere({0, 0, 0}, 10.98, {0, 0, -1}, 2, 100);
  membrane.params.substep_s = 0.0019;
  setup.membranes.push_back(membrane);
  EXPECT_THROW(Operation{setup}, InputError);
}

TEST(UnitOperation, TheFocusIsMeasuredInTheFrameOfTheHead) {
  // The eye is turned by 15 degrees about x. The tip lies in the focal plane of the head.
  OperationSample sample;
  sample.turn_degrees = {15, 0, 0};
  const EyeTurn turn{sample.turn_degrees * kRadiansPerDegree};
  sample.focus_mm = {0, 0, -10};
  sample.instruments.push_back({{}, {}, 0});
  sample.instruments[0].pose.tip_mm = turn.to_eye({2, 5, -10});
  OperationPlan plan;
  plan.instruments = {"needle"};
  ScoreRule rule;
  rule.category = ScoreCategory::microscope;
  rule.measure = "out_of_focus_mm";
  rule.instrument = "needle";
  plan.rules = {rule};
  ScoreKeeper keeper(plan);
  for (int n = 1; n < 5; ++n) {
    sample.time_s = n;
    keeper.take(sample);
  }
  EXPECT_NEAR(keeper.score().rules[0].measured, 0, 1e-9);
}

TEST(PropertyOperation, EqualTracksLeadToEqualStates) {
  OperationSetup setup = needle_in_eye();
  setup.tools.push_back(tool("forceps", InstrumentKind::forceps, {1, 1, -6}, "nasal"));
  OperationMembrane membrane;
  membrane.name = "membrane";
  membrane.mesh =
      membrane_on_sphere({0, 0, 0}, 11 - membrane.params.thickness_mm, {0, 0, -1}, 2, 200);
  setup.membranes.push_back(membrane);
  std::string digest;
  for (int run = 0; run < 2; ++run) {
    Operation operation(setup);
    for (int n = 1; n <= 60; ++n) {
      const double s = n / 60.0;
      operation.step({toward(operation, 0, {2 * s, 0, -5 - 6.5 * s}),
                      toward(operation, 1, {1 - s, 1, -6 - 4.9 * s})});
    }
    if (run == 0) digest = operation.digest();
    EXPECT_EQ(operation.digest(), digest);
  }
}

}  // namespace
}  // namespace supple
