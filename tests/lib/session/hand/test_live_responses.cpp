// Steps of finite elements that are sums of earlier ones, and responses under a hand.
#include <algorithm>
#include <cmath>
#include <functional>
#include <thread>

#include <gtest/gtest.h>

#include "lib/material/material.h"
#include "lib/session/hand/live_responses.h"
#include "lib/session/hand/solid_ahead.h"
#include "lib/session/kept_voxels.h"
#include "lib/session/session.h"
#include "lib/session/session_body.h"
#include "tests/support/program.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr int kLiveEdge = 14;
const IndexBox kLiveHandle{{5, 5, 12}, {8, 8, 13}}, kLiveFloor{{0, 0, 0}, {13, 13, 1}};
const IndexBox kLiveBone{{3, 3, 5}, {9, 6, 7}};

/// Tissue with a free bone in it.
class UnitLiveResponses : public ::testing::Test {
 protected:
  UnitLiveResponses() {
    std::string voxels;
    for (int k = 0; k < kLiveEdge; ++k) {
      for (int j = 0; j < kLiveEdge; ++j) {
        for (int i = 0; i < kLiveEdge; ++i) {
          voxels +=
              char(static_cast<unsigned char>(kLiveBone.contains(Vec3i(i, j, k)) ? 200 : 100));
        }
      }
    }
    write_text(m_folder / "block.raw", voxels);
    write_text(m_folder / "block.nhdr",
               "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 14 14 14\nspace directions: (1,0,0) (0,1,0) (0,0,1.5)\n"
               "space origin: (0,0,0)\nencoding: raw\ndata file: block.raw\n");
    m_options.material = parse_material(
        "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 1.6]]\n"
        "min_length = [[0, 0.6]]\nshear = [[0, 0.29]]\nrigid = [180, 255]\nrelax = false\n"
        "stiffness = [[0, 5]]\npoisson = [[0, 0.4]]\n",
        "test");
    m_options.keeps_undo = true;
  }

  /// The handle goes from where it is; its edge follows.
  static Step moved(const Vec3d& by_mm, double angle_deg = 0) {
    Step step;
    Drag drag;
    drag.selection.emplace().box = kLiveHandle;
    drag.soft_mm = 2;
    drag.by_mm = by_mm;
    drag.motion.axis_lps = {1, 2, 2};
    drag.motion.angle_deg = angle_deg;
    step.drags.push_back(drag);
    step.fix = {{kLiveFloor.lo, kLiveFloor.hi}};
    step.fem.emplace();
    step.fem->params.tolerance = 1e-8;
    step.tells_reactions = true;
    return step;
  }
  static double largest_difference(const Body& a, const Body& b) {
    double most = 0;
    for_each_element(a.elements, [&](Slot slot) {
      for (std::size_t c = 0; c < 3; ++c) {
        most = std::max(most, std::abs(double(a.q[c].at(slot)) - double(b.q[c].at(slot))));
      }
    });
    return most;
  }

  TemporaryFolder m_folder;
  SessionOptions m_options;
};

}  // namespace

TEST_F(UnitLiveResponses, AStepOfTheSameHandleIsASumAndCanBeUndone) {
  const auto path = m_folder / "block.nhdr";
  Step first = moved({0, 1, 0.5}), second = moved({0, 2, 1});
  first.drags[0].soft_mm = second.drags[0].soft_mm = 0;
  Session session(path, m_options), fresh(path, m_options);
  EXPECT_EQ(session.step(first).equilibrium.report.responses->solved, 1);
  second.drags[0].by_mm -= first.drags[0].by_mm;
  const FemReport& report = session.step(second).equilibrium.report;
  EXPECT_EQ(report.responses->solved, 0);
  EXPECT_EQ(report.responses->used, 1);
  EXPECT_EQ(report.iterations, 0);
  second.drags[0].by_mm += first.drags[0].by_mm;
  const StepRecord& record = fresh.step(second);
  EXPECT_LE(largest_difference(session.body(), fresh.body()), 1);
  const Vec3d force = record.reactions[0].reaction.force_n;
  EXPECT_LE((session.records().back().reactions[0].reaction.force_n - force).length(),
            1e-4 * force.length());  // of places that are rounded
  // An undone step has left nothing: the one after it is a sum of the same solutions.
  const auto hard = [](const Vec3d& by_mm) {
    Step step = moved(by_mm);
    step.drags[0].soft_mm = 0;
    return step;
  };
  EXPECT_TRUE(session.undo());
  session.step(hard({1, 0, 0}));
  EXPECT_TRUE(session.undo());
  Session straight(path, m_options);
  straight.step(first);
  const FemReport& after = session.step(hard({0.5, 0.25, 0.125})).equilibrium.report;
  straight.step(hard({0.5, 0.25, 0.125}));
  EXPECT_EQ(after.responses->solved, 1);
  EXPECT_EQ(largest_difference(session.body(), straight.body()), 0);
}

TEST_F(UnitLiveResponses, OtherHeldElementsOrAnotherMaterialAreToldAndFiniteStrainIsSolved) {
  Session session(m_folder / "block.nhdr", m_options);
  session.step(moved({0, 1, 0}));
  Step other = moved({0, 1, 0});
  other.drags[0].selection->box = IndexBox{{9, 9, 12}, {10, 10, 13}};
  EXPECT_EQ(session.step(other).equilibrium.report.responses->changed, "other held elements");
  Session large(m_folder / "block.nhdr", m_options);
  Step finite = moved({0, 0.2, 0});
  finite.fem->params.tolerance = 1e-4;
  finite.fem->params.strain = StrainTheory::finite;
  EXPECT_FALSE(large.step(finite).equilibrium.report.responses.has_value());
  Step stiffer = moved({0, 0.5, 0});
  stiffer.material = *m_options.material;
  stiffer.material->stiffness->keys[0].second = 7;
  EXPECT_EQ(session.step(stiffer).equilibrium.report.responses->changed, "other material");
}

TEST_F(UnitLiveResponses, AHandIsFollowedLevelByLevelAndTheStepAtItsEndIsASum) {
  Session session(m_folder / "block.nhdr", m_options);
  Step rest;
  rest.fix = {{kLiveFloor.lo, kLiveFloor.hi}};
  session.step(rest);
  Step grab = moved({0, 0, 0});
  grab.fix.clear();
  grab.drags[0].soft_mm = 0;
  HandleMotion quarter, half;
  quarter.axis_lps = half.axis_lps = {1, 2, 2};
  quarter.angle_deg = 90, half.angle_deg = 180;
  LiveResponses live(session.held_body(), grab,
                     {{{10, 0, 0}, {}}, {{0, 0, 10}, {}}, {{0, 0, 0}, quarter}, {{0, 0, 0}, half}});
  DragPose target{{1.5, 0, -1}, quarter};
  target.motion.angle_deg = 12;
  EXPECT_EQ(live.pose(target).level, -1);
  EXPECT_EQ(live.found(), nullptr);
  std::thread([&] { live.run(nullptr); }).join();
  ASSERT_TRUE(live.is_done());
  const LivePose pose = live.pose(target);
  EXPECT_EQ(pose.level + 1, live.ready());
  EXPECT_EQ(pose.error_mm, 0);
  EXPECT_NEAR(pose.beyond_mm, 0, 1e-9);
  EXPECT_GT(live.pose({{0, 1, 0}, {}}).beyond_mm, 0.9);

  session.held_body().responses = live.found();
  Step release = moved(target.by_mm, target.motion.angle_deg);
  release.fix.clear();
  release.drags[0].soft_mm = 0;
  const StepRecord& record = session.step(release);
  EXPECT_EQ(record.equilibrium.report.responses->solved, 0);
  const Vec3d force = record.reactions[0].reaction.force_n;
  EXPECT_LE((live.force_n(pose) - force).length(), 1e-4 * force.length());
  std::vector<Vec3f> u(live.elements());
  live.displacements(pose, 0, u.size(), u.data());
  const Body& body = session.body();
  std::size_t n = 0;
  double most_mm = 0;
  for_each_element(body.elements, [&](Slot slot) {
    Vec3d offset;
    for (std::size_t c = 0; c < 3; ++c) offset[int(c)] = double(body.q[c].at(slot)) / kFixedOne;
    const Vec3d there = body.geometry.world_vector_from_index(offset);
    if (body.rigid.at(slot) < 0) most_mm = std::max(most_mm, (Vec3d(u[n]) - there).length());
    ++n;
  });
  EXPECT_LE(most_mm, 1e-4);
  const std::vector<RigidPose> poses = live.piece_poses(pose);
  ASSERT_EQ(poses.size(), 1u);
  const RigidPose& by_step = body.rigid.list[0].pose;
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(double(poses[0].shift_q[c]), double(by_step.shift_q[c]), 3);
  }
  EXPECT_LE((poses[0].turn.v - by_step.turn.v).length(), 1e-5);
  // Some elements alone have the bits of all.
  std::vector<Vec3f> some(7);
  live.displacements(pose, 100, 107, some.data());
  EXPECT_TRUE(std::equal(some.begin(), some.end(), u.begin() + 100));
}

TEST_F(UnitLiveResponses, ASolidThatIsMadeAheadIsTakenAndChangesNoBits) {
  Session session(m_folder / "block.nhdr", m_options);
  Step grab = moved({0, 0, 0}), rest;
  rest.fix = std::exchange(grab.fix, {});
  session.step(rest);
  SessionBody& in = session.held_body();
  SolidAhead ahead(in, *grab.fem);
  EXPECT_EQ(ahead.voxels(), nullptr);
  ahead.run(nullptr);
  LiveResponses own(in, grab, {{{10, 0, 0}, {}}}), with(in, grab, {{{10, 0, 0}, {}}});
  own.run(nullptr);
  with.run(nullptr, ahead.voxels());
  EXPECT_EQ(with.found()->voxels, ahead.voxels());
  const DragPose target{{2, 0, 0}, {}};
  const auto at = [&](const LiveResponses& of) {
    std::vector<Vec3f> u(of.elements());
    of.displacements(of.pose(target), 0, u.size(), u.data());
    return u;
  };
  EXPECT_EQ(at(own), at(with));
  // The solid is not taken for another body.
  EXPECT_TRUE(ahead.is_of(in, *grab.fem));
  Step stiffer;
  stiffer.material = *m_options.material;
  stiffer.material->stiffness->keys[0].second = 7;
  session.step(stiffer);
  EXPECT_FALSE(ahead.is_of(in, *grab.fem));
  LiveResponses after(in, grab, {{{10, 0, 0}, {}}});
  after.run(nullptr, ahead.voxels());
  EXPECT_NE(after.found()->voxels, ahead.voxels());
}

TEST_F(UnitLiveResponses, AFurtherDirectionHasTheBitsOfOneFromTheStartWheneverItCame) {
  Session session(m_folder / "block.nhdr", m_options);
  Step grab = moved({0, 0, 0}), rest;
  grab.drags[0].soft_mm = 0;
  rest.fix = std::exchange(grab.fix, {});
  session.step(rest);
  SessionBody& in = session.held_body();
  const DragPose x{{10, 0, 0}, {}}, z{{0, 0, 10}, {}}, target{{2, 0, -1}, {}};
  const auto at = [&](const LiveResponses& of, const LivePose& pose) {
    std::vector<Vec3f> u(of.elements());
    of.displacements(pose, 0, u.size(), u.data());
    return u;
  };
  /// Asks for a direction at the n-th question whether to go on.
  struct Asking final : Progress {
    std::function<void()> ask;
    mutable int questions = 0;
    void stage(std::string_view) override {}
    void update(double) override {}
    bool cancelled() const override {
      if (--questions == 0) ask();
      return false;
    }
  };
  for (const FemAccuracy accuracy : {FemAccuracy::exact, FemAccuracy::voxel}) {
    grab.fem->params.set_accuracy(accuracy);
    LiveResponses both(in, grab, {x, z});
    both.run(nullptr);
    const std::vector<Vec3f> best = at(both, both.pose(target));
    for (const int questions : {2, 150, 400, 1'000'000}) {
      LiveResponses later(in, grab, {x});
      Asking asking;
      asking.questions = questions;
      asking.ask = [&] {
        EXPECT_FALSE(later.is_done());
        later.add(in, grab, z);
      };
      later.run(&asking);
      EXPECT_TRUE(later.is_done());
      if (asking.questions > 0) {  // it comes after all levels
        EXPECT_GT(later.pose(target).beyond_mm, 0.5);
        later.add(in, grab, z);
        EXPECT_FALSE(later.is_done());
        EXPECT_GT(later.pose(target).beyond_mm, 0.5);
        later.run(nullptr);
      }
      const LivePose pose = later.pose(target);
      EXPECT_LE(pose.beyond_mm, 1e-9);
      EXPECT_EQ(pose.error_mm, 0);
      EXPECT_EQ(at(later, pose), best) << questions;
      Session one(m_folder / "block.nhdr", m_options), other(m_folder / "block.nhdr", m_options);
      Step release = moved(target.by_mm);
      release.drags[0].soft_mm = 0;
      release.fix.clear();
      release.fem->params.set_accuracy(accuracy);
      one.step(rest);
      other.step(rest);
      one.held_body().responses = both.found();
      other.held_body().responses = later.found();
      EXPECT_EQ(one.step(release).equilibrium.report.responses->solved, 0);
      EXPECT_EQ(other.step(release).equilibrium.report.responses->solved, 0);
      EXPECT_EQ(largest_difference(one.body(), other.body()), 0);
    }
  }
}

TEST_F(UnitLiveResponses, ResponsesToATwentiethOfAVoxelServeTheStepToSuch) {
  const auto by_accuracy = [](Step step, FemAccuracy accuracy) {
    step.fix.clear();
    step.drags[0].soft_mm = 0;
    step.fem->params.set_accuracy(accuracy);
    return step;
  };
  Session session(m_folder / "block.nhdr", m_options), exact(m_folder / "block.nhdr", m_options);
  Step rest;
  rest.fix = {{kLiveFloor.lo, kLiveFloor.hi}};
  session.step(rest);
  exact.step(rest);
  LiveResponses live(session.held_body(), by_accuracy(moved({0, 0, 0}), FemAccuracy::voxel),
                     {{{10, 0, 0}, {}}, {{0, 0, 10}, {}}});
  live.run(nullptr);
  session.held_body().responses = live.found();
  const FemReport report =
      session.step(by_accuracy(moved({1.5, 0, -1}), FemAccuracy::voxel)).equilibrium.report;
  EXPECT_EQ(report.responses->solved, 0);
  EXPECT_EQ(report.responses->changed, "");
  ASSERT_TRUE(report.error_mm.has_value());
  EXPECT_LE(*report.error_mm, 0.05);
  exact.step(by_accuracy(moved({1.5, 0, -1}), FemAccuracy::exact));
  EXPECT_LE(largest_difference(session.body(), exact.body()), 0.1 * kFixedOne);
}

TEST_F(UnitLiveResponses, LevelsComeNearerToTheLastAndACancelledRunKeepsWhatItHas) {
  Session session(m_folder / "block.nhdr", m_options);
  Step grab = moved({0, 0, 0});
  Step rest;
  rest.fix = std::exchange(grab.fix, {});
  session.step(rest);
  const DragPose target{{2, 0, 0}, {}};

  /// Stops while a level is solved.
  struct Stopping final : Progress {
    LiveResponses* live = nullptr;
    void stage(std::string_view) override {}
    void update(double) override {}
    bool cancelled() const override { return live->ready() >= 2; }
  } stop;
  LiveResponses live(session.held_body(), grab, {{{10, 0, 0}, {}}});
  stop.live = &live;
  EXPECT_THROW(live.run(&stop), Cancelled);
  EXPECT_EQ(live.pose(target).level, 1);
  EXPECT_FALSE(live.is_done());
  const auto at = [&](const LiveResponses& of, const LivePose& pose) {
    std::vector<Vec3f> u(of.elements());
    of.displacements(pose, 0, u.size(), u.data());
    return u;
  };
  /// Keeps the pose of every level.
  struct Keeping final : Progress {
    std::function<LivePose()> pose;
    mutable std::vector<LivePose> poses;
    void stage(std::string_view) override {}
    void update(double) override {}
    bool cancelled() const override {
      const LivePose now = pose();
      if (now.level >= int(poses.size())) poses.push_back(now);
      return false;
    }
  } keeping;
  LiveResponses all(session.held_body(), grab, {{{10, 0, 0}, {}}});
  keeping.pose = [&] { return all.pose(target); };
  all.run(&keeping);
  const std::vector<Vec3f> best = at(all, all.pose(target));
  EXPECT_GE(keeping.poses.size(), 3);
  double before = std::numeric_limits<double>::infinity();
  for (std::size_t level = 0; level < keeping.poses.size(); ++level) {
    const LivePose& pose = keeping.poses[level];
    EXPECT_EQ(pose.level, int(level));
    const std::vector<Vec3f> u = at(all, pose);
    double sum = 0;
    for (std::size_t n = 0; n < u.size(); ++n) sum += (u[n] - best[n]).length();
    EXPECT_LE(sum, before) << level;
    before = sum;
  }
  // The error that is told of a level is above its own, where the body moves.
  LiveResponses some(session.held_body(), grab, {{{10, 0, 0}, {}}});
  stop.live = &some;
  EXPECT_THROW(some.run(&stop), Cancelled);
  const LivePose told = some.pose(target);
  const std::vector<Vec3f> u = at(some, told);
  std::vector<float> errors;
  float largest = 0;
  for (const Vec3f& there : best) largest = std::max(largest, there.length());
  for (std::size_t n = 0; n < u.size(); ++n) {
    if (best[n].length() >= 0.05F * largest) errors.push_back((u[n] - best[n]).length());
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_GE(told.error_mm, double(errors[errors.size() * 95 / 100]));
  EXPECT_LE(told.error_mm, double(largest));
}

TEST_F(UnitLiveResponses, AStepCanBeWhatAHandHasAtOneOfTheLevels) {
  const auto path = m_folder / "block.nhdr";
  for (const double angle_deg : {0.0, 5.0}) {
    Step step = moved({0.6, 0, 1}, angle_deg);
    step.drags[0].soft_mm = 0;  // thin edges are not linear
    Session solved(path, m_options);
    solved.step(step);
    std::vector<double> apart;
    std::array<std::int64_t, 3> bone{};
    for (int level = 1; level <= kAllLevels; ++level) {
      step.fem->hand_levels = level;
      Session session(path, m_options);
      EXPECT_EQ(settings_value(*session.step(step).fem)["hand_levels"].whole(), level);
      apart.push_back(largest_difference(session.body(), solved.body()) / double(kFixedOne));
      bone = session.body().rigid.list[0].pose.shift_q;
      EXPECT_TRUE(session.undo());
    }
    EXPECT_GT(apart.front(), 0.02) << angle_deg;
    EXPECT_LT(apart[2], apart[0]);
    EXPECT_LE(apart.back(), 0.02) << angle_deg;
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(double(bone[c]), double(solved.body().rigid.list[0].pose.shift_q[c]),
                  0.01 * double(kFixedOne));
    }
  }
  Step rest = moved({0, 0, 0});
  rest.fem->hand_levels = 2;
  Session resting(path, m_options);
  resting.step(rest);
  EXPECT_TRUE(resting.body().links_known_valid);
  Step two = moved({0, 0, 1});
  two.drags.push_back(two.drags.front());
  two.fem->hand_levels = 1;
  EXPECT_THROW(Session(path, m_options).step(two), InputError);
}
