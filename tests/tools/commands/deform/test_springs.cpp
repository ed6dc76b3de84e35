// Springs in scenes: models exchanged from step to step, what each reports, and what they leave.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lib/state/state.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

class Springs : public ::testing::Test {
 protected:
  void SetUp() override {
    write_ball(m_folder, "ball", 16);
    write_text(m_folder / "m.toml",
               "max_length = [[0, 1.5]]\nmin_length = [[0, 0.6]]\nshear = [[0, 0.25]]\n"
               "stiffness = [[0, 10]]\n");
  }

  Outcome run(const std::string& steps) {
    write_text(m_folder / "scene.toml",
               "[volume]\npath = \"ball.nhdr\"\n[material]\ntable = \"m.toml\"\n" + steps +
                   "[output]\nstate = \"out.vdb\"\n");
    return run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "", "--force", "--json"});
  }
  nlohmann::json steps_of(const std::string& steps) {
    const Outcome outcome = run(steps);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    m_warnings = outcome.err;
    if (outcome.exit_code != 0) return {};
    return nlohmann::json::parse(outcome.out)["steps"];
  }
  std::int32_t offset(const Vec3i& voxel, std::size_t c) const {
    const State state = read_state(m_folder / "out.vdb");
    return state.q[c].at(std::size_t(state.elements.find(voxel)) * kBrickVoxels +
                         std::size_t(brick_offset(voxel)));
  }

  /// Places of all elements, in LPS.
  struct Places {
    std::vector<Vec3d> rest_mm, now_mm;
  };
  Places places() const {
    const State state = read_state(m_folder / "out.vdb");
    Places found;
    for (int n = 0; n < 16 * 16 * 16; ++n) {
      const Vec3i voxel(n % 16, n / 16 % 16, n / 256);
      const std::int32_t b = state.elements.find(voxel);
      const int offset = brick_offset(voxel);
      if (b < 0 || !mask_test(state.elements.mask(std::size_t(b)), offset)) continue;
      Vec3d moved(voxel);
      for (int c = 0; c < 3; ++c) {
        moved[c] += state.q[std::size_t(c)].at(std::size_t(b) * kBrickVoxels + offset) / 65536.0;
      }
      found.rest_mm.push_back(state.geometry.world_from_index(Vec3d(voxel)));
      found.now_mm.push_back(state.geometry.world_from_index(moved));
    }
    return found;
  }

  const std::string m_pull =
      "[[step]]\ngrab = [8, 14, 8]\nby = [0, 4, 0]\nfix = [[0, 0, 0, 15, 4, 15]]\n";
  TemporaryFolder m_folder;
  std::string m_warnings;
};

using UnitSpringScene = Springs;
using FaultSpringScene = Springs;
using ConvergenceSpringScene = Springs;

}  // namespace

TEST_F(UnitSpringScene, AfterEcmSpringsComeToRestAndEcmRepairsWhatTheyBroke) {
  const auto steps = steps_of(m_pull +
                              "[[step]]\nmodel = \"springs\"\nsprings = { minimise = true }\n"
                              "[[step]]\nrelax = { passes = 5 }\n");
  ASSERT_EQ(steps.size(), 3u);
  const auto& springs = steps[1]["springs"];
  EXPECT_EQ(steps[1]["model"], "springs");
  EXPECT_LT(springs["energy_after_j"]["elastic"],
            0.5 * springs["energy_before_j"]["elastic"].get<double>());
  EXPECT_LE(springs["residual_mn"], 1e-3);
  EXPECT_FALSE(springs.contains("substeps"));
  // One element drawn out of the ball: springs stretch its links further than ChainMail would.
  EXPECT_GT(springs["violated"], 0);
  EXPECT_NE(m_warnings.find("beyond the material's limits"), std::string::npos) << m_warnings;
  EXPECT_EQ(steps[2]["projected"], springs["violated"]);
  EXPECT_NE(m_warnings.find("it was projected"), std::string::npos) << m_warnings;
  // What was dragged stays where it was dragged to, whatever the model.
  EXPECT_EQ(offset({8, 14, 8}, 1), 4 * 65536);
  EXPECT_EQ(offset({8, 4, 8}, 1), 0);
}

TEST_F(UnitSpringScene, EveryStepTellsThePullOfEveryHandle) {
  const auto steps =
      steps_of(m_pull + "[[step]]\nrelax = { passes = 2000 }\n" +
               "[[step]]\nmodel = \"springs\"\ngrab = [8, 2, 8]\nby = [1, 0, 0]\n" +
               "release = true\nfix = [[0, 5, 0, 15, 6, 15]]\nsprings = { minimise = true }\n");
  ASSERT_EQ(steps.size(), 3u);
  for (const std::size_t n : {0, 1}) {
    const auto& forces = steps[n]["reactions"];
    ASSERT_EQ(forces.size(), 1u);
    EXPECT_EQ(forces[0]["step"], 1);
    EXPECT_EQ(forces[0]["grab"], "8,14,8");
    EXPECT_LT(forces[0]["force_n"][1], 0);
    EXPECT_EQ(forces[0]["force_n"][0], 0);
  }
  // Relaxed tissue pulls less.
  EXPECT_GT(steps[1]["reactions"][0]["force_n"][1], steps[0]["reactions"][0]["force_n"][1]);
  ASSERT_EQ(steps[2]["reactions"].size(), 1u);
  EXPECT_EQ(steps[2]["reactions"][0]["step"], 3);
  EXPECT_LT(steps[2]["reactions"][0]["force_n"][0], 0);
}

TEST_F(UnitSpringScene, ThePressureOfCellsCountsUntilTheBodyIsMovedWithoutIt) {
  RUN_WHEN_SANITIZED();
  const std::string fix = "fix = [[0, 0, 0, 15, 4, 15]]\n";
  const auto steps = steps_of("[[step]]\ngrab = [8, 14, 8]\nby = [0, 4, 0]\n" + fix +
                              "relax = { passes = 100, bulk_modulus = 50 }\n[[step]]\n" + fix +
                              "[[step]]\ngrab = [8, 14, 8]\nby = [0, 0, 0]\n");
  const auto pull = [&](std::size_t n) {
    return steps[n]["reactions"][0]["force_n"][1].get<double>();
  };
  EXPECT_EQ(pull(1), pull(0));
  // A drag that moves nothing: only the pressure is gone.
  EXPECT_GT(std::abs(pull(2) - pull(0)), 0.05 * std::abs(pull(0)));
}

TEST_F(UnitSpringScene, WhatIsGrabbedAnewIsNoLongerTheEarlierHandles) {
  const std::string rest = "[[step]]\nmodel = \"springs\"\nsprings = { minimise = true }\n";
  const auto steps = steps_of(
      "[[step]]\ngrab_box = [7, 13, 7, 9, 13, 9]\nby = [0, 1, 0]\nfix = [[0, 0, 0, 15, 4, 15]]\n" +
      rest + "[[step]]\ngrab = [8, 13, 8]\nby = [0, 0, 0]\n" + rest +
      "[[step]]\ngrab_box = [7, 13, 7, 9, 13, 9]\nby = [0, 0, 0]\n" + rest);
  ASSERT_EQ(steps.size(), 6u);
  const auto pull = [&](std::size_t step) {
    double sum = 0;
    for (const auto& force : steps[step]["reactions"]) sum += force["force_n"][1].get<double>();
    return sum;
  };
  EXPECT_EQ(steps[1]["reactions"].size(), 1u);
  ASSERT_EQ(steps[3]["reactions"].size(), 2u);
  EXPECT_EQ(steps[3]["reactions"][1]["step"], 3);
  EXPECT_NE(steps[3]["reactions"][1]["force_n"][1], 0);
  ASSERT_EQ(steps[5]["reactions"].size(), 1u);
  EXPECT_EQ(steps[5]["reactions"][0]["step"], 5);
  // However it is shared out, all of it is told once.
  EXPECT_NEAR(pull(3), pull(1), 1e-3 * std::abs(pull(1)));
  EXPECT_NEAR(pull(5), pull(1), 1e-3 * std::abs(pull(1)));
}

TEST_F(UnitSpringScene, AMotionGoesOnInTheNextStepAndFromAState) {
  const std::string motion =
      "[[step]]\nmodel = \"springs\"\n"
      "springs = { time = TIME, step = 0.001, integrator = \"implicit\", gravity = [0, 9.81, 0] "
      "}\n";
  const auto of = [&](const std::string& time) {
    std::string text = motion;
    return text.replace(text.find("TIME"), 4, time);
  };
  const std::string fix = "[[step]]\nfix = [[0, 0, 0, 15, 4, 15]]\n";
  const auto once = steps_of(fix + of("0.02"));
  EXPECT_EQ(once[1]["springs"]["steps"], 20);
  EXPECT_GE(once[1]["springs"]["iterations"], 20);
  EXPECT_FALSE(once[1]["springs"].contains("residual_mn"));
  EXPECT_GT(once[1]["springs"]["energy_after_j"]["kinetic"], 0);
  const State whole = read_state(m_folder / "out.vdb");
  EXPECT_GT(whole.velocity_mm_s[1].at(std::size_t(whole.elements.find({8, 14, 8})) * kBrickVoxels +
                                      std::size_t(brick_offset({8, 14, 8}))),
            1);

  const auto close_to_whole = [&](double most) {
    const State found = read_state(m_folder / "out.vdb");
    for (std::size_t slot = 0; slot < whole.elements.brick_count() * kBrickVoxels; ++slot) {
      for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_NEAR(found.q[c].at(slot), whole.q[c].at(slot), 1);
        ASSERT_NEAR(found.velocity_mm_s[c].at(slot), whole.velocity_mm_s[c].at(slot), most);
      }
    }
  };
  steps_of(fix + of("0.01") + of("0.01"));
  close_to_whole(1e-5);
  // A file keeps offsets to 2^-16 voxel.
  steps_of(fix + of("0.01"));
  std::filesystem::rename(m_folder / "out.vdb", m_folder / "half.vdb");
  write_text(m_folder / "scene.toml",
             "[volume]\npath = \"half.vdb\"\n" + of("0.01") + "[output]\nstate = \"out.vdb\"\n");
  ASSERT_EQ(run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "", "--force"}).exit_code,
            0);
  close_to_whole(0.05);
}

TEST_F(UnitSpringScene, AFreeBodyFallsForTheTimeThatIsAsked) {
  steps_of(
      "[[step]]\nmodel = \"springs\"\n"
      "springs = { time = 0.01, step = 0.003, gravity = [0, 9.81, 0] }\n");
  const State state = read_state(m_folder / "out.vdb");
  const std::size_t slot = std::size_t(state.elements.find({8, 8, 8})) * kBrickVoxels +
                           std::size_t(brick_offset({8, 8, 8}));
  // Conjugate gradients leave 1e-8 of the forces in two Newton steps.
  EXPECT_NEAR(state.velocity_mm_s[1].at(slot), 9.81e3 * 0.01, 1e-5);
  EXPECT_NEAR(state.velocity_mm_s[0].at(slot), 0, 1e-5);
}

TEST_F(UnitSpringScene, HandlesMoveEvenlyOverTheTime) {
  const auto steps = steps_of(
      "[[step]]\nmodel = \"springs\"\ngrab = [8, 14, 8]\nby = [0, 4, 0]\n"
      "fix = [[0, 0, 0, 15, 4, 15]]\nsprings = { time = 0.01, step = 0.003 }\n");
  // No step longer than asked for.
  EXPECT_EQ(steps[0]["springs"]["steps"], 4);
  EXPECT_NEAR(steps[0]["settings"]["step_s"].get<double>(), 0.0025, 1e-15);
  EXPECT_EQ(offset({8, 14, 8}, 1), 4 * 65536);
  EXPECT_GT(offset({8, 13, 8}, 1), 65536);
  EXPECT_LT(steps[0]["reactions"][0]["force_n"][1], 0);
}

TEST_F(UnitSpringScene, OwnStiffnessesReplaceTheMaterials) {
  const auto at_rest = [&](const std::string& more) {
    return steps_of(m_pull + "[[step]]\nmodel = \"springs\"\nsprings = { minimise = true" + more +
                    " }\n")[1]["reactions"][0]["force_n"][1]
        .get<double>();
  };
  // 2/5 E h of 10 kPa, h the cube root of a voxel's 1.5 mm^3.
  const double k = 4 * std::cbrt(1.5), material = at_rest("");
  const auto both = [](double n_m) {
    return ", structural = " + std::to_string(n_m) + ", shear = " + std::to_string(n_m);
  };
  EXPECT_NEAR(at_rest(both(k)), material, 1e-4 * std::abs(material));
  EXPECT_NEAR(at_rest(both(2 * k)), 2 * material, 2e-4 * std::abs(material));
}

TEST_F(UnitSpringScene, AShapePressesTheBodyAside) {
  const auto press = [&](const std::string& more) {
    return steps_of(
        "[[step]]\nfix = [[0, 12, 0, 15, 15, 15]]\nmodel = \"springs\"\nsprings = { contact = "
        "{ plane = { point = [0, 2, 0], normal = [0, 2, 0] }" +
        more + " } }\n");
  };
  const auto still = press("");
  for (const Vec3d& pos : places().now_mm) EXPECT_GE(pos.y, 2 - 1e-4);
  const auto pressed = press(", by = [0, 4, 0], thickness = 0.5");
  EXPECT_EQ(pressed[0]["springs"]["penetration_mm"], 0);
  EXPECT_GT(pressed[0]["springs"]["contacts"], 100);
  EXPECT_EQ(pressed[0]["settings"]["contact"][0]["thickness"], 0.5);
  const Places found = places();
  double first_rest = 1e9, first = 1e9;
  for (std::size_t n = 0; n < found.now_mm.size(); ++n) {
    first_rest = std::min(first_rest, found.rest_mm[n].y);
    first = std::min(first, found.now_mm[n].y);
  }
  ASSERT_LT(first_rest, 3);
  EXPECT_NEAR(first, 6.5, 1e-4);
}

TEST_F(ConvergenceSpringScene, AMeshPressesAsTheBoxOfItsShape) {
  std::filesystem::create_directory(m_folder / "tools");
  write_text(m_folder / "tools/box.obj",
             "v 4 -4 4\nv 11 -4 4\nv 4 2 4\nv 11 2 4\nv 4 -4 14\nv 11 -4 14\nv 4 2 14\nv 11 2 14\n"
             "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n");
  const auto press = [&](const std::string& shape) {
    const auto steps = steps_of(
        "[[step]]\nfix = [[0, 12, 0, 15, 15, 15]]\nmodel = \"springs\"\nsprings = { contact = { " +
        shape + ", by = [0, 1.5, 0] } }\n");
    EXPECT_GT(steps[0]["springs"]["contacts"], 0);
    return steps[0]["settings"]["contact"][0];
  };
  press("box = { centre = [7.5, -1, 9], size = [7, 6, 10] }");
  const Places box = places();
  EXPECT_EQ(press("mesh = \"tools/box.obj\"")["mesh"], "box.obj");
  const Places mesh = places();
  double moved = 0;
  for (std::size_t n = 0; n < box.now_mm.size(); ++n) {
    // Steps end at a thousandth of their forces.
    EXPECT_LT((mesh.now_mm[n] - box.now_mm[n]).length(), 3e-3);
    moved = std::max(moved, (box.now_mm[n] - box.rest_mm[n]).length());
  }
  EXPECT_GT(moved, 1);
}

TEST_F(ConvergenceSpringScene, AMovingFloorTakesAlongByFriction) {
  const auto carried_by = [&](const std::string& friction) {
    steps_of(
        "[[step]]\nmodel = \"springs\"\nsprings = { step = 0.002, integrator = \"implicit\", "
        "gravity = [0, 9.81, 0], contact "
        "= "
        "{ box = { centre = [8, 100, 8], size = [200, 172, 200] }, by = [2, 0, 0], friction = " +
        friction + " } }\n");
    const Places found = places();
    double carried = 0, lowest = 0;
    for (const Vec3d& pos : found.rest_mm) lowest = std::max(lowest, pos.y);
    for (std::size_t n = 0; n < found.now_mm.size(); ++n) {
      EXPECT_LE(found.now_mm[n].y, 14 + 1e-4);
      if (found.rest_mm[n].y == lowest) carried = found.now_mm[n].x - found.rest_mm[n].x;
    }
    return carried;
  };
  EXPECT_NEAR(carried_by("0"), 0, 0.1);
  // The floor goes at 20 mm/s, and the ball falls by 1 mm before it is taken along. It is soft and
  // wobbles: steps of 2 and 0.5 ms differ by 0.25 mm.
  EXPECT_NEAR(carried_by("2"), 2 - 20 * std::sqrt(2 / 9810.0), 0.15);
}

TEST_F(FaultSpringScene, AMinimumThatIsNotReachedIsSaid) {
  steps_of(m_pull + "[[step]]\nmodel = \"springs\"\nsprings = { minimise = true, steps = 1 }\n");
  EXPECT_NE(m_warnings.find("no rest after 1 step"), std::string::npos) << m_warnings;
}

TEST_F(FaultSpringScene, WrongSettingsAreNamed) {
  const auto error = [&](const std::string& step) {
    const Outcome outcome = run("[[step]]\n" + step + "\n");
    EXPECT_EQ(outcome.exit_code, 3) << step;
    EXPECT_FALSE(std::filesystem::exists(m_folder / "out.vdb"));
    return outcome.err;
  };
  const auto expect = [&](const std::string& step, const std::string& words) {
    const std::string line = error(step);
    EXPECT_NE(line.find(words), std::string::npos) << line;
  };
  const std::string model = "model = \"springs\"\nsprings = ";
  expect("model = \"mesh\"", "expected ecm, springs, fem or tets");
  expect("springs = { time = 1 }", "expected model = \"springs\"");
  expect("relax = { passes = 3 }\nmodel = \"springs\"", "relax beside springs");
  expect("limits = \"ball\"\nmodel = \"springs\"", "limits beside springs");
  expect(model + "{ time = 0 }", "time: found 0, expected a positive number");
  expect(model + "{ step = nan }", "step: found nan");
  expect(model + "{ time = 1e9 }", "at most 1e+06 steps");
  expect(model + "{ integrator = \"rk4\" }", "expected symplectic, implicit, xpbd or projective");
  expect(model + "{ tolerance = 1 }", "tolerance without minimise");
  expect(model + "{ minimise = true, time = 1 }", "time beside minimise");
  expect(model + "{ minimise = true, steps = 0 }", "steps: found 0");
  expect(model + "{ shear = -1 }", "shear: found -1");
  expect(model + "{ gravty = [0, 0, 1] }", "gravity");
  expect(model + "{ minimise = true, contact = {} }", "contact beside minimise");
  expect(model + "{ contact = {} }", "one of sphere, plane, capsule, box and mesh");
  expect(model + "{ contact = { sphere = { centre = [0, 0, 0], radius = 0 } } }",
         "radius: found 0");
  expect(model + "{ contact = { box = { centre = [0, 0, 0], size = [1, -1, 1] } } }", "found -1");
  expect(model + "{ contact = { plane = { point = [0, 0, 0], normal = [0, 0, 0] } } }", "normal");
  expect(model + "{ contact = { mesh = \"none.stl\" } }", "none.stl");
  expect(model + "{ contact = { plane = {}, mesh = \"none.stl\" } }", "found several shapes");
  expect("grab = [8, 14, 8]\nby = [0, -1, 0]\npush = true\nmodel = \"springs\"",
         "a push handle beside springs");
  expect("grab = [8, 14, 8]\nby = [0, -1, 0]\npush = true\n[[step]]\nmodel = \"springs\"",
         "a push handle of an earlier drag, still held");
}
