// Volume conservation on the command line, in scenes and in states.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lib/state/state.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

class RelaxVolume : public ::testing::Test {
 protected:
  void SetUp() override {
    write_ball(m_folder, "ball", 12);
    write_soft_material(m_folder / "soft.toml");
  }

  Outcome deform(const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"deform",     m_folder / "ball.nhdr",
                                          "--material", m_folder / "soft.toml",
                                          "--grab",     "6,6,6",
                                          "--by",       "2,1,0",
                                          "--json",     "--force",
                                          "-o",         m_folder / "out.vdb"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_supple(arguments);
  }
  /// One step that relaxes so.
  Outcome scene(const std::string& relax) {
    write_text(m_folder / "scene.toml",
               "[volume]\npath = \"ball.nhdr\"\n"
               "[material]\ntable = \"soft.toml\"\n"
               "[[step]]\ngrab = [6, 6, 6]\nby = [2, 1, 0]\nrelax = " +
                   relax + "\n[output]\nstate = \"out.vdb\"\n");
    return run_supple({"run", m_folder / "scene.toml", "-o", m_folder.path(), "--force"});
  }

  TemporaryFolder m_folder;
};

using UnitRelaxVolume = RelaxVolume;
using FaultRelaxVolume = RelaxVolume;

}  // namespace

TEST_F(UnitRelaxVolume, DeformReportsTheVolumeAndTheStateRemembersTheModulus) {
  const Outcome outcome = deform({"--relax", "30", "--bulk-modulus", "100"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto relax = nlohmann::json::parse(outcome.out)["relax"];
  EXPECT_EQ(relax["bulk_modulus_kpa"], 100);
  EXPECT_EQ(relax["volumes_before"]["rest_mm3"], relax["volumes_after"]["rest_mm3"]);
  EXPECT_LT(relax["volumes_before"]["smallest_cell_ratio"],
            relax["volumes_after"]["smallest_cell_ratio"]);
  EXPECT_NEAR(relax["volumes_after"]["ratio"], 1, 0.01);
  const auto kept = nlohmann::json::parse(read_state(m_folder / "out.vdb").configuration);
  EXPECT_EQ(kept["steps"][0]["relax"]["bulk_modulus_kpa"], 100);
}

TEST_F(UnitRelaxVolume, ASceneAndDeformAgree) {
  RUN_WHEN_SANITIZED();
  ASSERT_EQ(deform({"--relax", "30", "--bulk-modulus", "100"}).exit_code, 0);
  const auto by_deform = read_state(m_folder / "out.vdb").q;
  const Outcome outcome = scene("{ passes = 30, bulk_modulus = 100 }");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(read_state(m_folder / "out.vdb").q, by_deform);
}

TEST_F(UnitRelaxVolume, PoissonsRatioOfTheMaterialGivesTheModulus) {
  write_text(m_folder / "soft.toml",
             read_text(m_folder / "soft.toml") + "stiffness = [[0, 2]]\npoisson = [[0, 0.45]]\n");
  Outcome outcome = scene("{ passes = 30, poisson = true }");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const State state = read_state(m_folder / "out.vdb");
  const auto relax = nlohmann::json::parse(state.configuration)["steps"][0]["relax"];
  EXPECT_EQ(relax["poisson"], true);
  EXPECT_FALSE(relax.contains("bulk_modulus_kpa"));
  ASSERT_EQ(scene("{ passes = 30, bulk_modulus = 20 }").exit_code, 0);
  EXPECT_EQ(read_state(m_folder / "out.vdb").q, state.q);
  outcome = scene("{ poisson = true, bulk_modulus = 1 }");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.err.find("relax.poisson: found poisson beside bulk_modulus"), std::string::npos)
      << outcome.err;
  outcome = scene("{ poisson = true, method = \"plain\" }");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.err.find("relax.poisson: found method \"plain\""), std::string::npos)
      << outcome.err;
}

/// Root mean square of the distances between the elements of two states of one body, in voxels.
double distance_between(const State& a, const State& b) {
  const Displacement u = displacement_of(a), v = displacement_of(b);
  double sum = 0;
  for (std::size_t n = 0; n < a.elements.brick_count(); ++n) {
    const Vec3f* const here = u.u.vectors.brick_or_zero(n);
    const Vec3f* const there = v.u.vectors.brick_or_zero(n);
    for_each_active(a.elements.mask(n),
                    [&](int offset) { sum += double((here[offset] - there[offset]).length2()); });
  }
  return std::sqrt(sum / double(a.elements.active_count()));
}

TEST_F(UnitRelaxVolume, TheFittedPresetIsNearerToFiniteElementsThanItsSpringsAlone) {
  write_text(m_folder / "springs.toml", "preset = \"elastic-tissue\"\nrelax = true\n");
  const auto moved = [&](const std::string& material, const std::vector<std::string>& more) {
    std::vector<std::string> words = {
        "deform", m_folder / "ball.nhdr", "--material", material,   "--fix",  "8,0,0:11,11,11",
        "--grab", "1,4,4:3,7,7",          "--by",       "-1.5,0,0", "--json", "--force",
        "-o",     m_folder / "out.vdb"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_supple(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome;
  };
  moved("elastic-tissue", {"--model", "fem"});
  const State truth = read_state(m_folder / "out.vdb");
  moved(m_folder / "springs.toml", {});
  const double springs = distance_between(read_state(m_folder / "out.vdb"), truth);
  const Outcome outcome = moved("elastic-tissue", {});
  const State state = read_state(m_folder / "out.vdb");
  EXPECT_LT(distance_between(state, truth), 0.6 * springs);
  const auto relax = nlohmann::json::parse(outcome.out)["relax"];
  EXPECT_NEAR(relax["bulk_modulus_kpa"], 3.25 / (1 - 2 * 0.48), 1e-9);
  EXPECT_NE(state.material_toml.find("relax = \"poisson\""), std::string::npos);
}

TEST_F(FaultRelaxVolume, AMaterialIsRelaxedByPoissonsRatioWithSixLinksAlone) {
  const auto refused = [&](const std::string& keys) {
    write_text(m_folder / "soft.toml", "preset = \"elastic-tissue\"\n" + keys);
    return deform({}).err;
  };
  EXPECT_NE(refused("links = 26\n")
                .find("relax: found \"poisson\" with 26 links, expected 6 links, or true"),
            std::string::npos);
  EXPECT_NE(refused("relax = \"fully\"\n")
                .find("relax: found \"fully\", expected true, false or \"poisson\""),
            std::string::npos);
  EXPECT_EQ(refused("links = 26\nrelax = true\n").find("error"), std::string::npos);
}

TEST_F(UnitRelaxVolume, WithoutItNeitherTheReportNorTheStateMentionsIt) {
  const Outcome outcome = deform({"--relax", "3"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out.find("volume"), std::string::npos);
  EXPECT_EQ(read_state(m_folder / "out.vdb").configuration.find("bulk_modulus_kpa"),
            std::string::npos);
}

TEST_F(UnitRelaxVolume, FormerNamesAreReadWithAWarning) {
  const Outcome option = deform({"--relax", "3", "--relax-volume", "100"});
  EXPECT_EQ(option.exit_code, 0) << option.err;
  EXPECT_NE(option.err.find("--relax-volume: this option is called --bulk-modulus now"),
            std::string::npos)
      << option.err;
  const Outcome key = scene("{ passes = 3, volume = 100 }");
  EXPECT_EQ(key.exit_code, 0) << key.err;
  EXPECT_NE(key.err.find("step[1].relax.volume: found its former name, expected "
                         "step[1].relax.bulk_modulus"),
            std::string::npos)
      << key.err;
  EXPECT_EQ(scene("{ volume = 1, bulk_modulus = 1 }").exit_code, 3);
}

TEST_F(FaultRelaxVolume, BadModuliAndMethodsAreRefused) {
  const Outcome below = deform({"--relax", "3", "--bulk-modulus", "-1"});
  EXPECT_EQ(below.exit_code, 3);
  EXPECT_NE(below.err.find("--bulk-modulus: found -1, expected 0 to"), std::string::npos)
      << below.err;
  const Outcome jacobi =
      deform({"--relax", "3", "--bulk-modulus", "100", "--relax-method", "jacobi"});
  EXPECT_EQ(jacobi.exit_code, 3);
  EXPECT_NE(jacobi.err.find("--bulk-modulus: found method \"jacobi\""), std::string::npos)
      << jacobi.err;
  const Outcome negative = scene("{ bulk_modulus = -1 }");
  EXPECT_EQ(negative.exit_code, 3);
  EXPECT_NE(negative.err.find("relax.bulk_modulus: found -1, expected 0 to"), std::string::npos)
      << negative.err;
  const Outcome plain = scene("{ bulk_modulus = 1, method = \"plain\" }");
  EXPECT_EQ(plain.exit_code, 3);
  EXPECT_NE(plain.err.find("relax.bulk_modulus: found method \"plain\""), std::string::npos)
      << plain.err;
}
