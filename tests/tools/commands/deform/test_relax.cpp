// Relaxation on the command line, in scenes and in states.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lib/state/state.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

const std::string kMaterial =
    "max_length = [[0, 1.5]]\nmin_length = [[0, 0.6]]\nshear = [[0, 0.25]]\n";

class Relax : public ::testing::Test {
 protected:
  void SetUp() override {
    write_ball(m_folder, "ball", 16);
    write_text(m_folder / "m.toml", kMaterial);
  }

  Outcome deform(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "deform");
    arguments.insert(arguments.end(), {"--force", "-o", m_folder / "out.vdb"});
    return run_supple(arguments);
  }
  /// A pull at the ball's front, its back fixed.
  Outcome pull(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(),
                     {m_folder / "ball.nhdr", "--material", m_folder / "m.toml", "--grab", "8,14,8",
                      "--by", "0,4,0", "--fix", "0,0,0:15,4,15"});
    return deform(arguments);
  }

  TemporaryFolder m_folder;
};

using UnitRelax = Relax;
using FaultRelax = Relax;

}  // namespace

TEST_F(UnitRelax, DeformSaysWhatARelaxationDid) {
  const Outcome outcome = pull({"--relax", "30", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto relax = nlohmann::json::parse(outcome.out)["relax"];
  EXPECT_EQ(relax["method"], "accelerated");
  EXPECT_EQ(relax["passes"], 30);
  EXPECT_LT(relax["energy_after_uj"].get<double>(), 0.6 * relax["energy_before_uj"].get<double>());
  EXPECT_GT(relax["energy_after_uj"].get<double>(), 0);

  const Outcome text = pull({"--relax", "5", "--relax-method", "jacobi"});
  EXPECT_NE(text.out.find("pull at 8,14,8          "), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("relaxed         5 passes (jacobi), energy "), std::string::npos)
      << text.out;
}

TEST_F(UnitRelax, MaterialsThatAskForItAreRelaxedUnlessTheStepSaysOtherwise) {
  const auto relaxed = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"--json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = pull(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out).value("relax", nlohmann::json());
  };
  EXPECT_TRUE(relaxed({}).is_null());
  write_text(m_folder / "m.toml", kMaterial + "links = 26\nrelax = true\n");
  const nlohmann::json asked = relaxed({});
  EXPECT_GT(asked["passes"], 20);
  EXPECT_EQ(asked["ended_by"], "converged");
  EXPECT_TRUE(relaxed({"--no-relax"}).is_null());
  EXPECT_EQ(relaxed({"--relax", "3"})["passes"], 3);
  // A step that drags nothing is as it was asked for.
  const Outcome released = deform({m_folder / "out.vdb", "--release", "--json"});
  ASSERT_EQ(released.exit_code, 0) << released.err;
  EXPECT_FALSE(nlohmann::json::parse(released.out).contains("relax"));
  // The state keeps the material, and the record what was done.
  EXPECT_NE(read_state(m_folder / "out.vdb").material_toml.find("relax = true"), std::string::npos);

  const Outcome both = pull({"--relax", "3", "--no-relax"});
  EXPECT_EQ(both.exit_code, 3);
  EXPECT_NE(both.err.find("--no-relax: found no_relax beside relax"), std::string::npos)
      << both.err;
}

TEST_F(UnitRelax, ABudgetEndsItAfterTheSameWorkOnAnyMachine) {
  const auto relaxed = [&](const std::string& threads) {
    const Outcome outcome =
        pull({"--relax", "5000", "--relax-budget", "0.5", "--threads", threads, "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("ended by its budget"), std::string::npos) << outcome.err;
    nlohmann::json relax = nlohmann::json::parse(outcome.out)["relax"];
    relax.erase("relax_ms");
    return relax;
  };
  const nlohmann::json one = relaxed("1");
  EXPECT_EQ(one["ended_by"], "budget");
  // Eight bricks, one coordinate in motion: at most 4096 elements a pass.
  EXPECT_GE(one["passes"], 122);
  EXPECT_LE(one["passes"], 400);
  EXPECT_EQ(one, relaxed("3"));
}

TEST_F(UnitRelax, ItEndsWhenNothingMovesFurtherThanTheTolerance) {
  const Outcome outcome = pull({"--relax", "5000", "--relax-tolerance", "0.001", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto relax = nlohmann::json::parse(outcome.out)["relax"];
  EXPECT_EQ(relax["converged"], true);
  EXPECT_LT(relax["passes"], 1000);
  EXPECT_LE(relax["largest_step_voxels"].get<double>(), 0.001);
}

TEST_F(UnitRelax, ThePlainPassIsWarnedOf) {
  const Outcome outcome = pull({"--relax", "1", "--relax-method", "plain"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("plain relaxation broke "), std::string::npos) << outcome.err;
  // The state is continued by projecting it.
  const Outcome next = deform({m_folder / "out.vdb", "--relax", "1"});
  ASSERT_EQ(next.exit_code, 0) << next.err;
  EXPECT_NE(next.err.find("it was projected"), std::string::npos) << next.err;
}

TEST_F(UnitRelax, AReleasedStateReturnsToItsShape) {
  ASSERT_EQ(pull({"--relax", "20"}).exit_code, 0);
  ASSERT_EQ(deform({m_folder / "out.vdb", "--relax", "2000"}).exit_code, 0);
  for (const BrickValues& q : read_state(m_folder / "out.vdb").q) {
    for (std::size_t slot = 0; slot < q.brick_count() * kBrickVoxels; ++slot) {
      ASSERT_LE(std::abs(q.at(slot)), 65);  // a thousandth of a voxel
    }
  }
}

TEST_F(UnitRelax, APlasticStateKeepsItsSetInTheFile) {
  RUN_WHEN_SANITIZED();
  write_text(m_folder / "m.toml", kMaterial + "plastic = [[0, 0.02]]\n");
  const Outcome outcome = pull({"--relax", "200", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_GT(nlohmann::json::parse(outcome.out)["relax"]["yielded_links"], 10);
  const State before = read_state(m_folder / "out.vdb");
  EXPECT_FALSE(before.rest[1][1].empty());
  EXPECT_TRUE(before.rest[1][0].empty());

  ASSERT_EQ(deform({m_folder / "out.vdb", "--fix", "8,8,8"}).exit_code, 0);
  EXPECT_TRUE(read_state(m_folder / "out.vdb").rest == before.rest);

  ASSERT_EQ(deform({m_folder / "out.vdb", "--relax", "2000"}).exit_code, 0);
  const State after = read_state(m_folder / "out.vdb");
  const std::size_t slot = std::size_t(after.elements.find({8, 14, 8})) * kBrickVoxels +
                           std::size_t(brick_offset({8, 14, 8}));
  EXPECT_GT(after.q[1].at(slot), 65536 / 2);
  EXPECT_LT(after.q[1].at(slot), before.q[1].at(slot));
}

TEST_F(UnitRelax, AStepOfASceneRelaxesWhatEarlierOnesHold) {
  write_text(m_folder / "scene.toml",
             "[volume]\npath = \"ball.nhdr\"\n[material]\ntable = \"m.toml\"\n"
             "[[step]]\ngrab = [8, 14, 8]\nby = [0, 4, 0]\nfix = [[0, 0, 0, 15, 4, 15]]\n"
             "[[step]]\nrelax = { passes = 40, tolerance = 1e-6, method = \"red-black\" }\n"
             "[output]\nstate = \"scene.vdb\"\n");
  const Outcome outcome =
      run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto steps = nlohmann::json::parse(outcome.out)["steps"];
  EXPECT_FALSE(steps[0].contains("relax"));
  EXPECT_EQ(steps[1]["relax"]["method"], "red-black");

  ASSERT_EQ(
      pull({"--relax", "40", "--relax-tolerance", "1e-6", "--relax-method", "red-black"}).exit_code,
      0);
  const State scene = read_state(m_folder / "scene.vdb");
  EXPECT_EQ(scene.q, read_state(m_folder / "out.vdb").q);
  EXPECT_NE(scene.configuration.find(
                "\"relax\":{\"passes\":40,\"method\":\"red-black\",\"tolerance_voxels\":1e-06}"),
            std::string::npos)
      << scene.configuration;
}

TEST_F(FaultRelax, WrongSettingsAreNamed) {
  const auto scene_error = [&](const std::string& relax) {
    write_text(m_folder / "scene.toml",
               "[volume]\npath = \"ball.nhdr\"\n[material]\ntable = "
               "\"m.toml\"\n[[step]]\nrelax = " +
                   relax + "\n");
    const Outcome outcome = run_supple({"run", m_folder / "scene.toml", "--dry-run"});
    EXPECT_EQ(outcome.exit_code, 3);
    return outcome.err;
  };
  EXPECT_NE(scene_error("{ passes = 0 }")
                .find("scene.toml:6: step[1].relax.passes: found 0, expected 1 to"),
            std::string::npos);
  EXPECT_NE(scene_error("{ tolerance = -1 }").find("tolerance: found -1"), std::string::npos);
  EXPECT_NE(
      scene_error("{ method = \"fast\" }").find("expected plain, jacobi, red-black or accelerated"),
      std::string::npos);
  EXPECT_NE(scene_error("{ pases = 3 }").find("passes"), std::string::npos);

  EXPECT_EQ(pull({"--relax", "0"}).exit_code, 3);
  EXPECT_EQ(pull({"--relax", "5", "--relax-method", "fast"}).exit_code, 2);
  const Outcome word = pull({"--relax", "often"});
  EXPECT_EQ(word.exit_code, 2);
  EXPECT_NE(word.err.find("--relax: found 'often', expected a number"), std::string::npos)
      << word.err;
}
