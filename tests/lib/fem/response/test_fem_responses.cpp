// Sums of responses against fresh solutions of the same motions.
#include <algorithm>
#include <atomic>
#include <cmath>

#include <gtest/gtest.h>

#include "lib/fem/response/response_set.h"
#include "lib/fem/voxel/level_solver.h"
#include "tests/lib/fem_fixtures.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;

namespace {

HeldElements held(SlotSet elements, std::function<Vec3d(const Vec3d&)> displacement_mm) {
  HeldElements all;
  all.elements = std::move(elements);
  all.displacement_mm = std::move(displacement_mm);
  return all;
}

constexpr double kTolerance = 1e-9;

FemParams exactly() {
  FemParams params;
  params.tolerance = kTolerance;
  params.reaction_tolerance = kTolerance;
  return params;
}

ElasticTable even_elastic() {
  ElasticTable table;
  table.young_kpa.fill(3);
  table.poisson.fill(0.4);
  return table;
}

/// Cancels once, after so many questions.
class CancelAfter final : public Progress {
 public:
  explicit CancelAfter(int polls) : m_left(polls) {}
  void stage(std::string_view) override {}
  void update(double) override {}
  bool cancelled() const override { return --m_left < 0; }

 private:
  mutable std::atomic<int> m_left;
};

/// A turn, a scale and a shift about a point, of any size.
std::function<Vec3d(const Vec3d&)> random_motion(std::mt19937& random, const Vec3d& about) {
  std::uniform_real_distribution<double> one(-1, 1);
  const Turn turn = turn_about(Vec3d(one(random), one(random), one(random) + 2), 180 * one(random));
  const Vec3d scale(1 + 0.5 * one(random), 1 + 0.5 * one(random), 1 + 0.5 * one(random));
  const Vec3d shift(5 * one(random), 5 * one(random), 5 * one(random));
  return [=](const Vec3d& x) { return turn((x - about) * scale) + shift - (x - about); };
}

/// A body whose lower part is held, with the elements of handles above.
struct HandledBody {
  Body body;
  ElasticTable elastic;
  std::vector<SlotSet> handles;
  SlotSet fixed;

  HandledBody(std::mt19937& random, int handles_wanted)
      : body(random_fem_body(random, Vec3i(9, 9, 9))), elastic(random_elastic(random)) {
    std::vector<Slot> low;
    const IndexBox box = body.elements.active_bounds();
    const int width = box.hi.x - box.lo.x + 1;
    std::vector<std::vector<Slot>> of_handle(static_cast<std::size_t>(handles_wanted));
    for_each_element(body.elements, [&](Slot slot) {
      const Vec3i v = voxel_of(body.elements, slot);
      if (v.z == box.lo.z) low.push_back(slot);
      const int piece = (v.x - box.lo.x) * 2 * handles_wanted / width;
      if (v.z >= box.hi.z - 1 && v.z > box.lo.z && piece % 2 == 0) {
        of_handle[std::size_t(piece / 2)].push_back(slot);
      }
    });
    for (std::vector<Slot>& slots : of_handle) {
      if (!slots.empty()) handles.emplace_back(std::move(slots));
    }
    fixed = SlotSet(std::move(low));
  }

  FemLoads loads(std::mt19937& random) const {
    FemLoads all;
    for (const SlotSet& handle : handles) {
      const Vec3d about =
          body.geometry.world_from_index(Vec3d(voxel_of(body.elements, handle.first())));
      all.held.push_back(held(handle, random_motion(random, about)));
    }
    all.held.push_back(held(fixed, nullptr));
    return all;
  }
};

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t n = 0; n < a.size(); ++n) most = std::max(most, std::abs(a[n] - b[n]));
  return most;
}

}  // namespace

TEST(PropertyFemResponses, SumsOfRandomMotionsAreTheSolutionsOfThese) {
  std::mt19937 random(55);
  constexpr int kBodies = 5, kMotions = 40;
  int sums = 0;
  for (int number = 0; number < kBodies; ++number) {
    const HandledBody of(random, 1 + number % 2);
    const FemModel model(of.body, of.elastic);
    ResponseSet known;
    for (int motion = 0; motion < kMotions; ++motion) {
      const FemLoads loads = of.loads(random);
      const FemSolution sum = model.solve_by(known, loads, exactly());
      const FemSolution fresh = model.solve(loads, exactly());
      ASSERT_TRUE(sum.report.responses.has_value());
      if (sum.report.responses->solved == 0) ++sums;
      ASSERT_LE(largest_difference(sum.u_mm, fresh.u_mm), 1e-5 * largest(fresh.u_mm));
      ASSERT_EQ(sum.reactions.size(), fresh.reactions.size());
      double force = 0, moment = 0;
      for (const FemReaction& of_grip : fresh.reactions) {
        force = std::max(force, of_grip.force_n.length());
        moment = std::max(moment, of_grip.moment_nmm.length());
      }
      for (std::size_t n = 0; n < fresh.reactions.size(); ++n) {
        const FemReaction &by_sum = sum.reactions[n], &by_itself = fresh.reactions[n];
        EXPECT_LE((by_sum.force_n - by_itself.force_n).length(), 1e-5 * force);
        EXPECT_LE((by_sum.moment_nmm - by_itself.moment_nmm).length(), 1e-5 * moment);
      }
      EXPECT_NEAR(sum.report.energy_mj, fresh.report.energy_mj, 1e-5 * fresh.report.energy_mj);
    }
    EXPECT_LE(known.size(), 12 * of.handles.size());
  }
  EXPECT_GE(sums, kBodies * (kMotions - 24));
}

TEST(PropertyFemResponses, AStraightWayTakesOneSolutionAPlaneTwoAndARingTwo) {
  const Body body = fem_cube(8);
  const FemModel model(body, even_elastic());
  const auto solutions = [&](auto&& displacement_of) {
    ResponseSet known;
    for (int n = 1; n <= 6; ++n) {
      FemLoads loads;
      loads.held.push_back(
          held(elements_in(body, {Vec3i(3, 3, 7), Vec3i(5, 4, 7)}), displacement_of(double(n))));
      loads.held.push_back(held(elements_in(body, {Vec3i(0, 0, 0), Vec3i(7, 7, 0)}), nullptr));
      const FemSolution solution = model.solve_by(known, loads, {});
      EXPECT_EQ(solution.report.responses->changed, "");
    }
    return known.size();
  };
  const auto shift = [](const Vec3d& by) { return [by](const Vec3d&) { return by; }; };
  EXPECT_EQ(solutions([&](double t) { return shift(Vec3d(1, 2, 3) * (t / 4)); }), 1u);
  EXPECT_EQ(solutions([&](double t) {
              return shift(Vec3d(std::cos(t), std::sin(t), 0.5 * t * t - t * t / 2));
            }),
            2u);
  EXPECT_EQ(solutions([](double t) {
              const Turn turn = turn_about(Vec3d(1, 2, 2), 10 * t);
              return [turn](const Vec3d& x) {
                return turn(x - Vec3d(4, 4, 7)) - (x - Vec3d(4, 4, 7));
              };
            }),
            2u);
}

TEST(UnitFemResponses, LoadsAreABaseSolutionAndOtherHeldElementsForgetAll) {
  const Body body = fem_cube(6);
  const FemModel model(body, even_elastic());
  ResponseSet known;
  const auto solve = [&](const Vec3d& shift, double force_n, const IndexBox& handle) {
    FemLoads loads;
    loads.held.push_back(held(elements_in(body, handle), [=](const Vec3d&) { return shift; }));
    loads.held.push_back(held(elements_in(body, {Vec3i(0, 0, 0), Vec3i(5, 5, 0)}), nullptr));
    if (force_n != 0) {
      loads.forces.push_back(
          {elements_in(body, {Vec3i(0, 2, 3), Vec3i(1, 3, 4)}), {force_n, 0, 0}});
    }
    const FemSolution sum = model.solve_by(known, loads, exactly());
    const FemSolution fresh = model.solve(loads, exactly());
    EXPECT_LE(largest_difference(sum.u_mm, fresh.u_mm), 1e-5 * largest(fresh.u_mm));
    return *sum.report.responses;
  };
  const IndexBox handle{Vec3i(2, 2, 5), Vec3i(3, 3, 5)}, larger{Vec3i(2, 2, 5), Vec3i(4, 3, 5)};
  EXPECT_EQ(solve({0, 0, 1}, 0.01, handle).solved, 1);
  EXPECT_EQ(solve({1, 0, 0}, 0.01, handle).solved, 1);
  const ResponseReport sum = solve({3, 0, -2}, 0.01, handle);
  EXPECT_EQ(sum.solved, 0);
  EXPECT_EQ(sum.used, 2);
  EXPECT_EQ(solve({3, 0, -2}, 0.02, handle).changed, "other loads");
  EXPECT_EQ(solve({3, 0, -2}, 0.02, larger).changed, "other held elements");
  EXPECT_EQ(known.size(), 0u);
}

TEST(UnitFemResponses, SolutionsToAWeakerErrorServeNoStricterOne) {
  const Body body = fem_cube(6);
  const FemModel model(body, even_elastic());
  ResponseSet known;
  const auto changed = [&](const FemParams& params) {
    FemLoads loads;
    loads.held.push_back(held(elements_in(body, {Vec3i(2, 2, 5), Vec3i(3, 3, 5)}),
                              [](const Vec3d&) { return Vec3d(1, 0, 0); }));
    loads.held.push_back(held(elements_in(body, {Vec3i(0, 0, 0), Vec3i(5, 5, 0)}), nullptr));
    return model.solve_by(known, loads, params).report.responses->changed;
  };
  FemParams weak, strict;
  weak.error_mm = 0.1;
  strict.error_mm = 0.01;
  EXPECT_EQ(changed(weak), "");
  EXPECT_EQ(changed(weak), "");
  EXPECT_EQ(changed(strict), "other tolerances");
  EXPECT_EQ(changed(FemParams()), "other tolerances");
}

TEST(PropertyFemResponses, SumsHaveTheSameBitsOnAnyNumberOfThreads) {
  const Body body = fem_cube(24);
  const FemModel model(body, even_elastic());
  std::vector<std::vector<double>> results;
  for (const int threads : {1, 2, 5, 8}) {
    const ThreadLimit limit(threads);
    std::mt19937 random(8);
    ResponseSet known;
    std::vector<double> all;
    for (int motion = 0; motion < 3; ++motion) {
      FemLoads loads;
      loads.held.push_back(held(elements_in(body, {Vec3i(4, 4, 22), Vec3i(9, 20, 23)}),
                                random_motion(random, Vec3d(6, 12, 22))));
      loads.held.push_back(held(elements_in(body, {Vec3i(0, 0, 0), Vec3i(23, 23, 1)}), nullptr));
      const FemSolution sum = model.solve_by(known, loads, {});
      all.insert(all.end(), sum.u_mm.begin(), sum.u_mm.end());
      for (const FemReaction& reaction : sum.reactions) all.push_back(reaction.force_n.x);
    }
    results.push_back(std::move(all));
  }
  for (const std::vector<double>& result : results) EXPECT_TRUE(result == results.front());
}

TEST(PropertyFemResponses, LevelsAfterEachOtherHaveTheBitsOfEachAlone) {
  // A thin plate, which the finest level alone knows of, on a block.
  const Body body = fem_body(20, [](const Vec3i& v) {
    if (v.z < 12) return 100;
    return v.x == 9 ? 200 : -1;
  });
  ElasticTable elastic = even_elastic();
  elastic.young_kpa[200] = 300;
  const FemModel model(body, elastic);
  FemLoads loads;
  loads.held.push_back(held(elements_in(body, {Vec3i(9, 4, 18), Vec3i(9, 15, 19)}),
                            [](const Vec3d&) { return Vec3d(2, 0, 1); }));
  loads.held.push_back(held(elements_in(body, {Vec3i(0, 0, 0), Vec3i(19, 19, 1)}), nullptr));
  FemReport report;
  const NodalLoads moved = model.checked_loads(loads, {}, nullptr, report);
  NodalLoads still = moved;
  std::fill(still.u_mm.begin(), still.u_mm.end(), 0.0);
  std::vector<NodalLoads> both = {still, moved};
  LevelSolver solver(model);
  for (NodalLoads& one : both) solver.add(one);
  const int deepest = int(model.levels().meshes.size()) - 1;
  EXPECT_GE(deepest, 2);
  for (int doublings = deepest; doublings >= 0; --doublings) {
    FemParams params;
    params.doublings = doublings;
    params.tolerance = 1e-4;
    both = {still, moved};
    solver.prepare(doublings, nullptr);
    const NodalSolution of_still = solver.solve(0, params, false, nullptr);
    const NodalSolution of_moved = solver.solve(1, params, false, nullptr);
    const NodalSolution alone = model.solve_beside({moved}, params).front();
    EXPECT_GT(alone.iterations, 0);
    EXPECT_EQ(of_moved.iterations, alone.iterations) << doublings;
    EXPECT_TRUE(of_moved.u_mm == alone.u_mm) << doublings;
    EXPECT_TRUE(of_still.u_mm == still.u_mm);
  }
  // Few iterations are a solution only where that is allowed; what is allowed later, or is
  // interrupted, goes on as if there had been no end.
  const auto solved = [&](const std::vector<int>& allowed, bool may_be_rough, int polls = 0) {
    NodalLoads one = moved;
    LevelSolver by_steps(model);
    by_steps.add(one);
    by_steps.prepare(0, nullptr);
    NodalSolution out;
    for (const int iterations : allowed) {
      FemParams few;
      few.max_iterations = iterations;
      CancelAfter cancel(polls);
      if (polls > 0) {
        EXPECT_THROW(by_steps.solve(0, few, may_be_rough, &cancel), Cancelled);
      }
      out = by_steps.solve(0, few, may_be_rough, nullptr);
      EXPECT_EQ(out.iterations, iterations);
    }
    return out.u_mm;
  };
  EXPECT_THROW(solved({1}, false), NotConverged);
  const std::vector<double> at_once = solved({4}, true);
  EXPECT_TRUE(solved({4}, true, 30) == at_once);
  const std::vector<double> gone_on = solved({1, 4}, true);
  double largest = 0, apart = 0;
  for (std::size_t n = 0; n < at_once.size(); ++n) {
    largest = std::max(largest, std::abs(at_once[n]));
    apart = std::max(apart, std::abs(at_once[n] - gone_on[n]));
  }
  EXPECT_LE(apart, 1e-6 * largest);
}
