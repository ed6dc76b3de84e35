// Finite elements by the program: volumes of stress, gauges, reactions, and what is refused.
#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/io/load/load.h"
#include "volumes/io/warp_file.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr Vec3i kBarDims(6, 5, 9);

/// A bar of voxels of 1 x 0.5 x 2 mm, of E = 20 kPa and nu = 0, so that between its held ends it
/// is stretched evenly. Its middle has label 1, its ends have label 2.
class UnitFemScene : public ::testing::Test {
 protected:
  UnitFemScene() {
    write_bar("bar", [](const Vec3i&) { return 100; });
    write_bar("labels", [](const Vec3i& v) { return v.z == 0 || v.z == 8 ? 2 : 1; });
    write_text(m_folder / "tissue.toml",
               "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 1.5]]\n"
               "min_length = [[0, 0.6]]\nshear = [[0, 0.25]]\nstiffness = [[0, 20]]\n"
               "poisson = [[0, 0]]\n");
  }

  void write_bar(const std::string& name, const std::function<int(const Vec3i&)>& value) {
    std::string voxels;
    for (int k = 0; k < kBarDims.z; ++k) {
      for (int j = 0; j < kBarDims.y; ++j) {
        for (int i = 0; i < kBarDims.x; ++i) {
          voxels += char(static_cast<unsigned char>(value({i, j, k})));
        }
      }
    }
    write_text(m_folder / (name + ".raw"), voxels);
    write_text(m_folder / (name + ".nhdr"),
               "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 6 5 9\nspace directions: (1,0,0) (0,0.5,0) (0,0,2)\n"
               "space origin: (0,0,0)\nencoding: raw\ndata file: " +
                   name + ".raw\n");
  }

  /// The upper end pulled by an eighth of a millimetre, or as the options say.
  std::vector<std::string> stretch(const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"deform",     m_folder / "bar.nhdr",
                                          "--material", m_folder / "tissue.toml",
                                          "--model",    "fem",
                                          "--grab",     "0,0,8:5,4,8",
                                          "--by",       "0,0,0.125",
                                          "--fix",      "0,0,0:5,4,0",
                                          "-o",         m_folder / "state.vdb"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  /// A scene of that step with these keys of `fem` and these lines after it.
  std::string scene(const std::string& fem, const std::string& after = "") {
    const std::string path = m_folder / "scene.toml";
    write_text(path,
               "[volume]\npath = \"bar.nhdr\"\n[material]\ntable = \"tissue.toml\"\n[[step]]\n"
               "model = \"fem\"\nfem = { " +
                   fem +
                   " }\ngrab_box = [0, 0, 8, 5, 4, 8]\nby = [0.0, 0.0, 0.125]\n"
                   "fix = [[0, 0, 0, 5, 4, 0]]\n" +
                   after);
    return path;
  }

  /// The bar stretched as that step does, `by` far, then let go for a motion with these keys.
  std::string swing(const std::string& motion, const std::string& by, const std::string& after) {
    const std::string path = scene("");
    std::string text = read_text(path);
    text.replace(text.find("[0.0, 0.0, 0.125]"), 17, by);
    write_text(path, text +
                         "[[step]]\nmodel = \"fem\"\nrelease = true\n"
                         "fix = [[0, 0, 0, 5, 4, 0]]\nfem = { motion = { " +
                         motion + " } }\n" + after);
    return path;
  }

  /// The numbers of a table.
  std::vector<std::vector<double>> rows_of(const std::string& name) const {
    std::istringstream lines(read_text(m_folder / name));
    std::vector<std::vector<double>> rows;
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      std::istringstream cells(line);
      rows.emplace_back();
      for (std::string cell; std::getline(cells, cell, ',');) {
        rows.back().push_back(std::stod(cell));
      }
    }
    return rows;
  }

  // Seven voxels of 2 mm between the held ones.
  const double m_strain = 0.125 / 14, m_stress_kpa = 20 * m_strain;
  TemporaryFolder m_folder;
};

}  // namespace

TEST_F(UnitFemScene, VolumesGaugesAndReactionsOfAStretchedBarAreThoseByHand) {
  RUN_WHEN_SANITIZED();
  const Outcome outcome = run_supple(stretch(
      {"--labels", m_folder / "labels.nhdr", "--elements", "von_mises=" + (m_folder / "mises.nrrd"),
       "--elements", "pressure=" + (m_folder / "pressure.mha"), "--elements",
       "energy_density=" + (m_folder / "energy.nii"), "--elements",
       "strain_1=" + (m_folder / "strain.nrrd"), "--json"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  const auto& gauges = json["fem"]["gauges"];
  ASSERT_EQ(gauges.size(), 2u);
  EXPECT_EQ(gauges[0]["label"], 1);
  EXPECT_EQ(gauges[0]["elements"], 6 * 5 * 7);
  EXPECT_NEAR(gauges[0]["strain_1"], m_strain, 1e-6);
  EXPECT_NEAR(gauges[0]["von_mises"], m_stress_kpa, 1e-5);
  EXPECT_NEAR(gauges[0]["principal_1"], m_stress_kpa, 1e-5);
  EXPECT_NEAR(gauges[0]["energy_density"], m_stress_kpa * m_strain / 2, 1e-7);
  EXPECT_NEAR(gauges[1]["von_mises"], 0, 1e-6);
  // 6 x 2.5 mm^2, in N.
  EXPECT_NEAR(json["reactions"][0]["force_n"][2], -m_stress_kpa * 15e-3, 1e-7);

  const struct {
    const char* file;
    double value;
  } expected[] = {{"mises.nrrd", m_stress_kpa},
                  {"pressure.mha", -m_stress_kpa / 3},
                  {"energy.nii", m_stress_kpa * m_strain / 2},
                  {"strain.nrrd", m_strain}};
  for (const auto& [file, value] : expected) {
    const Volume volume = load_volume(m_folder / file);
    EXPECT_EQ(volume.geometry.dims(), kBarDims) << file;
    EXPECT_NEAR(volume.geometry.spacing_mm().z, 2, 1e-6) << file;
    for (int k = 0; k < kBarDims.z; ++k) {
      const bool is_held = k == 0 || k == 8;
      for (const Vec3i& voxel : {Vec3i(0, 0, k), Vec3i(5, 4, k), Vec3i(2, 1, k)}) {
        EXPECT_NEAR(volume.density.at(voxel), is_held ? 0 : value, 2e-5 * std::abs(value) + 1e-7)
            << file << voxel;
      }
    }
  }
}

TEST_F(UnitFemScene, AccuracySetsLimitsAndWhatStandsBesideItReplacesThem) {
  RUN_WHEN_SANITIZED();
  const auto steps = [&](const std::string& fem, const std::string& after = "") {
    const Outcome run = run_supple({"run", scene(fem, after), "-o", m_folder / "out", "--json"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out)["steps"];
  };
  const auto tolerances = [](const nlohmann::json& step) {
    const nlohmann::json& settings = step["settings"];
    return std::pair<double, double>(settings["tolerance"], settings["reaction_tolerance"]);
  };
  const nlohmann::json voxel = steps("accuracy = \"voxel\"")[0], exact = steps("")[0],
                       picture = steps("accuracy = \"picture\"")[0];
  EXPECT_EQ(tolerances(exact), std::pair(1e-6, 1e-5));
  EXPECT_FALSE(exact["settings"].contains("error_mm"));
  EXPECT_FALSE(exact["settings"].contains("accuracy"));  // as records were before
  EXPECT_EQ(steps("accuracy = \"exact\"")[0]["settings"], exact["settings"]);
  EXPECT_EQ(tolerances(picture), std::pair(0.1, 0.1));
  EXPECT_LE(picture["fem"]["iterations"], exact["fem"]["iterations"]);
  EXPECT_EQ(voxel["settings"]["error_mm"], 0.025);  // a twentieth of 0.5 mm
  EXPECT_FALSE(voxel["settings"].contains("tolerance"));
  EXPECT_FALSE(voxel["settings"].contains("reaction_tolerance"));
  EXPECT_LE(voxel["fem"]["error_left_mm"], 0.025);
  EXPECT_LE(voxel["fem"]["reaction_change"], 0.02);
  EXPECT_LE(voxel["fem"]["iterations"], exact["fem"]["iterations"]);
  EXPECT_FALSE(voxel["settings"].contains("accuracy"));
  // A step of the recorded settings is solved again as it was.
  EXPECT_EQ(steps("error_mm = 0.025")[0]["settings"], voxel["settings"]);
  EXPECT_EQ(tolerances(steps("tolerance = 0.01")[0]), std::pair(0.01, 1e-5));
  EXPECT_EQ(tolerances(steps("tolerance = 0.01, accuracy = \"picture\"")[0]), std::pair(0.01, 0.1));

  // A picture goes on from the one before it; an exact step is a sum of what the one before found.
  const std::string again = "[[step]]\nmodel = \"fem\"\n";
  const nlohmann::json pictures =
      steps("accuracy = \"picture\"", again + "fem = { accuracy = \"picture\" }\n");
  EXPECT_EQ(pictures[1]["fem"]["iterations"], 1);
  const nlohmann::json twice = steps("", again);
  EXPECT_EQ(twice[1]["fem"]["iterations"], 0);
  EXPECT_EQ(twice[1]["fem"]["responses"]["solved"], 0);
  EXPECT_GT(twice[1]["fem"]["responses"]["used"], 0);

  const Outcome by_option = run_supple(stretch({"--accuracy", "picture", "--json"}));
  ASSERT_EQ(by_option.exit_code, 0) << by_option.err;
  EXPECT_NE(by_option.out.find("\"accuracy\": \"picture\""), std::string::npos) << by_option.out;
}

TEST_F(UnitFemScene, HowAStepIsToldDoesNotChangeWhereItEnds) {
  RUN_WHEN_SANITIZED();
  const auto run = [&](const std::string& outputs, const std::vector<std::string>& more) {
    const std::string path =
        scene("accuracy = \"voxel\"", "[output]\noffsets = [\"warp.nrrd\"]\n" + outputs);
    std::vector<std::string> words = {"run", path, "-o", m_folder / "out", "--force"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_supple(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return std::pair(read_text(m_folder / "out/warp.nrrd"), outcome.out);
  };
  EXPECT_EQ(run("", {}).first, run("", {"--json"}).first);
  // Forces that a scene writes are asked for.
  const auto json = nlohmann::json::parse(run("forces = \"forces.csv\"\n", {"--json"}).second);
  EXPECT_LE(json["steps"][0]["fem"]["reaction_change"], 1e-3);
  EXPECT_EQ(json["steps"][0]["settings"]["reaction_tolerance"], 1e-3);
}

TEST_F(UnitFemScene, TheAccuracyOfARunReplacesTheTolerancesOfItsScene) {
  RUN_WHEN_SANITIZED();
  const auto run = [&](const std::string& fem, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"run",    scene(fem, ""), "-o", m_folder / "out",
                                      "--json", "--force"};
    words.insert(words.end(), more.begin(), more.end());
    return run_supple(words);
  };
  const auto settings = [&](const std::string& fem, const std::vector<std::string>& more) {
    const Outcome outcome = run(fem, more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out)["steps"][0]["settings"];
  };
  const std::string picture = "accuracy = \"picture\"";
  EXPECT_EQ(settings("", {"--accuracy", "picture"}), settings(picture, {}));
  EXPECT_EQ(settings(picture, {"--accuracy", "voxel"}), settings("accuracy = \"voxel\"", {}));
  EXPECT_EQ(settings("tolerance = 0.01", {"--accuracy", "exact"}), settings("", {}));
  EXPECT_EQ(run("", {"--accuracy", "coarse"}).exit_code, 2);
  for (const char* other : {"--method", "--budget", "--error"}) {
    EXPECT_EQ(run("", {"--accuracy", "exact", other, "1s"}).exit_code, 2) << other;
  }
  std::string without = read_text(scene("", ""));
  for (const std::string line : {"model = \"fem\"\n", "fem = {  }\n"}) {
    without.erase(without.find(line), line.size());
  }
  write_text(m_folder / "ecm.toml", without);
  const Outcome ecm = run_supple(
      {"run", m_folder / "ecm.toml", "-o", m_folder / "out", "--force", "--accuracy", "exact"});
  EXPECT_EQ(ecm.exit_code, 3);
  EXPECT_NE(ecm.err.find("--accuracy: found no step of finite elements"), std::string::npos)
      << ecm.err;
}

TEST_F(UnitFemScene, WarningsOfTurnsAndStrainsNameVoxels) {
  RUN_WHEN_SANITIZED();
  std::vector<std::string> far = stretch({});
  *(std::find(far.begin(), far.end(), "--by") + 1) = "0,0,2";
  const Outcome run = run_supple(far);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::size_t at = run.err.find("beyond linear theory");
  ASSERT_NE(at, std::string::npos) << run.err;
  EXPECT_NE(run.err.find("strains of up to 0.1", 0), std::string::npos) << run.err;
  EXPECT_NE(run.err.rfind("at voxel ", at), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("in 210 elements", at), std::string::npos) << run.err;  // what is not held
}

TEST_F(UnitFemScene, SmallerElementsStretchTheBarAlike) {
  RUN_WHEN_SANITIZED();
  const std::string path = scene("refine = 1", "[output]\nelements = { von_mises = \"m.nrrd\" }\n");
  std::string text = read_text(path);
  text.insert(text.find("[material]"), "[labels]\npath = \"labels.nhdr\"\n");
  write_text(path, text);
  const Outcome outcome = run_supple({"run", path, "-o", m_folder / "", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto step = nlohmann::json::parse(outcome.out)["steps"][0];
  EXPECT_EQ(step["fem"]["elements"], 8 * 6 * 5 * 9);
  EXPECT_EQ(step["fem"]["gauges"][0]["elements"], 6 * 5 * 7);
  EXPECT_NEAR(step["fem"]["gauges"][0]["von_mises"], m_stress_kpa, 1e-5);
  EXPECT_NEAR(step["reactions"][0]["force_n"][2], -m_stress_kpa * 15e-3, 1e-7);
  const Volume volume = load_volume(m_folder / "m.nrrd");
  EXPECT_NEAR(volume.density.at({2, 1, 4}), m_stress_kpa, 1e-4 * m_stress_kpa);
  EXPECT_NEAR(volume.density.at({2, 1, 8}), 0, 1e-5);
  for (const char* beside : {"motion = { time = 1 }", "modes = { count = 1 }"}) {
    const Outcome refused =
        run_supple({"run", scene("refine = 1, " + std::string(beside)), "-o", m_folder / ""});
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_NE(refused.err.find("smaller elements beside"), std::string::npos) << refused.err;
  }
  for (const char* beside :
       {"motion = { time = 1 }", "modes = { count = 1 }", "strain = \"finite\"", "refine = 1"}) {
    const Outcome refused =
        run_supple({"run", scene("coarsen = 1, " + std::string(beside)), "-o", m_folder / ""});
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_NE(refused.err.find("larger elements beside"), std::string::npos) << refused.err;
  }
  for (const char* beside :
       {"motion = { time = 1 }", "modes = { count = 1 }", "strain = \"finite\"", "coarsen = 1"}) {
    const Outcome refused = run_supple(
        {"run", scene("solver = \"calculix\", " + std::string(beside)), "-o", m_folder / ""});
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_NE(refused.err.find("solver"), std::string::npos) << refused.err;
  }
}

TEST_F(UnitFemScene, ConventionsOfBoneLaboratoriesAreKeysAndOptions) {
  RUN_WHEN_SANITIZED();
  // Two columns that touch along an edge; one is held, the other one drawn.
  write_bar("bar", [](const Vec3i& v) { return (v.x < 3) == (v.y < 2) ? 100 : 0; });
  const auto pull = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = stretch(more);
    *(std::find(arguments.begin(), arguments.end(), "--grab") + 1) = "0,0,8:2,1,8";
    *(std::find(arguments.begin(), arguments.end(), "--fix") + 1) = "3,2,0:5,4,0";
    arguments.insert(arguments.end(), {"--json", "--force"});
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  };
  const auto apart = pull({}), joined = pull({"--touching", "joined", "--integration", "full"});
  EXPECT_FALSE(apart["settings"].contains("touching"));
  EXPECT_FALSE(apart["settings"].contains("integration"));
  EXPECT_EQ(joined["settings"]["touching"], "joined");
  EXPECT_EQ(joined["settings"]["integration"], "full");
  EXPECT_NEAR(apart["reactions"][0]["force_n"][2], 0, 1e-9);
  EXPECT_LT(joined["reactions"][0]["force_n"][2], -1e-5);
  EXPECT_EQ(int(apart["fem"]["nodes"]) - int(joined["fem"]["nodes"]), 10);
  for (const char* key : {"integration", "touching"}) {
    const Outcome refused =
        run_supple({"run", scene(std::string(key) + " = \"half\""), "-o", m_folder / ""});
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_NE(refused.err.find("fem." + std::string(key) + ": found \"half\", expected "),
              std::string::npos)
        << refused.err;
  }
}

TEST_F(UnitFemScene, AVolumeLiesWhereItsElementsAre) {
  RUN_WHEN_SANITIZED();
  // A bar with a hole: bricks with gaps.
  write_bar("bar", [](const Vec3i& v) { return v.x == 2 && v.y < 3 && v.z == 4 ? 0 : 100; });
  const Outcome outcome = run_supple(
      {"run", scene("", "[output]\nelements = { von_mises = \"m.nrrd\" }\n"), "-o", m_folder / ""});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Volume volume = load_volume(m_folder / "m.nrrd");
  EXPECT_EQ(volume.density.at({2, 1, 4}), 0);
  // What the hole does not carry goes past it.
  EXPECT_GT(volume.density.at({2, 3, 4}), 1.1 * m_stress_kpa);
  EXPECT_LT(volume.density.at({2, 1, 5}), 0.9 * m_stress_kpa);
  EXPECT_GT(volume.density.at({5, 1, 7}), 0.5 * m_stress_kpa);
  EXPECT_EQ(volume.density.at({5, 4, 8}), 0);
}

TEST_F(UnitFemScene, WhatDoesNotConvergeHasItsNumbersAndNoOutput) {
  RUN_WHEN_SANITIZED();
  const Outcome outcome =
      run_supple({"run", scene("max_iterations = 1", "[output]\nstate = \"state.vdb\"\n"), "-o",
                  m_folder / "out"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("finite elements did not converge: residual "), std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("after 1 iterations, "), std::string::npos) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  for (const std::string& name : m_folder.entries()) {
    EXPECT_EQ(name.find("state"), std::string::npos) << name;
  }
}

TEST_F(UnitFemScene, AnIslandIsWarnedOfOrRefused) {
  RUN_WHEN_SANITIZED();
  write_bar("bar", [](const Vec3i& v) { return v.x == 4 ? 0 : 100; });
  const std::string output = "[output]\nstate = \"state.vdb\"\n";
  const auto run = [&](const std::string& fem) {
    const std::string path = scene(fem, output);
    std::string text = read_text(path);
    text.replace(text.find("[0, 0, 8, 5"), 11, "[0, 0, 8, 3");
    text.replace(text.find("[0, 0, 0, 5"), 11, "[0, 0, 0, 3");
    write_text(path, text);
    return run_supple({"--force", "run", path, "-o", m_folder / ""});
  };
  const Outcome held = run("");
  EXPECT_EQ(held.exit_code, 0) << held.err;
  EXPECT_NE(held.err.find("nothing holds 1 island of 45 elements"), std::string::npos) << held.err;
  const Outcome refused = run("loose = \"refuse\"");
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("1 pieces of 45 elements that nothing holds"), std::string::npos)
      << refused.err;
}

TEST_F(UnitFemScene, AtFiniteStrainABarIsStretchedByAHalf) {
  RUN_WHEN_SANITIZED();
  std::vector<std::string> arguments =
      stretch({"--strain", "finite", "--elements", "strain_1=" + (m_folder / "strain.nrrd"),
               "--elements", "von_mises=" + (m_folder / "mises.nrrd"), "--json"});
  arguments[9] = "0,0,7";  // half of 14 mm
  const Outcome outcome = run_supple(arguments);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("linear theory"), std::string::npos) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["settings"]["strain"], "finite");
  EXPECT_GE(json["fem"]["newton"]["load_steps"], 1);
  EXPECT_GT(json["fem"]["newton"]["smallest_det_f"], 0.5);
  EXPECT_LT(json["fem"]["force_balance"], 1e-6);
  // Far from the ends, which hold the section, the bar grows thinner, and longer by a half.
  const double strain = load_volume(m_folder / "strain.nrrd").density.at({2, 2, 4});
  EXPECT_NEAR(strain, 0.5, 0.05);
  // Linear theory would give 10 kPa.
  EXPECT_NEAR(load_volume(m_folder / "mises.nrrd").density.at({2, 2, 4}), 7.75, 0.25);
}

TEST_F(UnitFemScene, ABarThatIsLetGoSwingsAndIsFilmed) {
  RUN_WHEN_SANITIZED();
  // 16 mm of it are free; a wave goes along them and back in 4 L / c. Half of that later all odd
  // waves are where they were, with the other sign.
  const double period_s = 4 * 16e-3 / std::sqrt(20e3 / 1000);
  const std::string watch = "watch = [[2, 2, 8], [0, 0, 0]]";
  const std::string path =
      swing("time = " + std::to_string(period_s) + ", step = 1e-4, " + watch, "[0, 0, 0.125]",
            "[film]\nframes = 5\n[output]\ndisplacements = [\"u_%d.nrrd\"]\n"
            "motion = \"swing.csv\"\n");
  const Outcome outcome = run_supple({"run", path, "-o", m_folder / "", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto motion = nlohmann::json::parse(outcome.out)["steps"][1]["fem"]["motion"];
  EXPECT_EQ(motion["steps"], 144);
  EXPECT_LT(motion["energy_error"], 1e-4);
  EXPECT_EQ(motion["dissipated_mj"], 0);
  EXPECT_EQ(motion["work_mj"], 0);  // nothing that is held moves
  const std::vector<std::vector<double>> rows = rows_of("swing.csv");
  ASSERT_EQ(rows.size(), 145u);
  EXPECT_EQ(read_text(m_folder / "swing.csv").find("time_s,elastic_mj,kinetic_mj,work_mj,"), 0u);
  // Columns of u of the voxels follow five of energy and size.
  EXPECT_EQ(rows[0].size(), 12u);
  EXPECT_NEAR(rows[0][8], 0.125, 1e-6);
  EXPECT_NEAR(rows[72][8], -0.125, 0.01);
  EXPECT_NEAR(rows[144][8], 0.125, 0.01);
  EXPECT_NEAR(rows[144][0], period_s, 1e-4 * period_s);
  for (const std::vector<double>& row : rows) {
    EXPECT_NEAR(row[1] + row[2], rows[0][1], 1e-4 * rows[0][1]);
    EXPECT_EQ(row[11], 0);
  }
  for (const int frame : {0, 2, 4}) {
    const Warp warp = read_warp(m_folder / ("u_" + std::to_string(frame) + ".nrrd"));
    EXPECT_NEAR(warp.vectors[(8 * 5 + 2) * 6 + 2].z, rows[std::size_t(36 * frame)][8], 1e-4)
        << frame;
  }
}

TEST_F(UnitFemScene, DampingOfTheMaterialTakesEnergy) {
  RUN_WHEN_SANITIZED();
  write_text(m_folder / "tissue.toml",
             read_text(m_folder / "tissue.toml") + "damping = [[0, 2]]\n");
  const Outcome outcome =
      run_supple({"run", swing("time = 0.05", "[0, 0, 0.125]", ""), "-o", m_folder / "", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto motion = nlohmann::json::parse(outcome.out)["steps"][1]["fem"]["motion"];
  EXPECT_EQ(motion["steps"], 100);
  // The bar swings at 70 Hz, with a damping ratio of 0.44.
  EXPECT_GT(motion["dissipated_mj"], 100 * double(motion["elastic_mj"]));
  EXPECT_LT(motion["energy_error"], 1e-4);
}

TEST_F(UnitFemScene, AHandleMovesSmoothlyInTimeAndFeelsTheBody) {
  RUN_WHEN_SANITIZED();
  const std::string path =
      scene("motion = { time = 0.4, step = 2e-3, ramp = 0.2, mass_damping = 40 }",
            "[output]\nstate = \"state.vdb\"\nmotion = \"pull.csv\"\n");
  const Outcome outcome = run_supple({"run", path, "-o", m_folder / "", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto step = nlohmann::json::parse(outcome.out)["steps"][0];
  const std::vector<std::vector<double>> rows = rows_of("pull.csv");
  ASSERT_EQ(rows.size(), 201u);
  EXPECT_EQ(rows[0].size(), 9u);  // with the force on the handle
  EXPECT_NE(read_text(m_folder / "pull.csv").find(",force_1_1_z_n\n"), std::string::npos);
  // It rests at the end under the force that equilibrium has.
  EXPECT_NEAR(rows.back()[8], -m_stress_kpa * 15e-3, 1e-3 * m_stress_kpa * 15e-3);
  EXPECT_NEAR(step["reactions"][0]["force_n"][2], rows.back()[8], 1e-8);
  EXPECT_NEAR(rows[50][5], 0.0625, 1e-3);  // half of the way in half of the time
  EXPECT_LT(step["fem"]["motion"]["energy_error"], 0.01);
  EXPECT_GT(step["fem"]["motion"]["dissipated_mj"], 0);
  const auto& motion = step["fem"]["motion"];
  EXPECT_NEAR(motion["work_mj"], double(motion["elastic_mj"]) + double(motion["dissipated_mj"]),
              0.01 * double(motion["work_mj"]));
  // The state goes on: at rest, as far as anyone can see.
  const Outcome on = run_supple({"deform", m_folder / "state.vdb", "--model", "fem", "--json", "-o",
                                 m_folder / "on.vdb", "--fix", "0,0,0:5,4,0"});
  EXPECT_EQ(on.exit_code, 0) << on.err;
}

TEST_F(UnitFemScene, MotionsThatCannotBeAreErrors) {
  RUN_WHEN_SANITIZED();
  const auto expect_error = [&](const std::string& path, const std::string& line,
                                const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"run", path, "-o", m_folder / "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    EXPECT_NE(outcome.err.find(line), std::string::npos) << outcome.err;
  };
  expect_error(scene("motion = { step = 1e-3 }", ""), "motion.time");
  expect_error(scene("motion = { time = 0.1, step = -1 }", ""), "step");
  expect_error(scene("motion = { time = 1e3, step = 1e-6 }", ""), "at most 1000000 steps");
  expect_error(scene("motion = { time = 0.1 }, modes = { count = 2 }", ""),
               "a motion beside modes");
  expect_error(scene("motion = { time = 0.1 }, strain = \"finite\"", ""), "finite beside a motion");
  expect_error(scene("motion = { time = 0.1, watch = [[9, 9, 9]] }", ""),
               "watch: found voxel 9,9,9");
  expect_error(scene("motion = { time = 0.1 }", "[film]\nfps = 25\n"), "film.frames");
  expect_error(scene("", "[output]\nmotion = \"a.csv\"\n"),
               "output.motion: found no motion in time");
  expect_error(scene("motion = { time = 0.1 }", "[output]\nmotion = \"a.txt\"\n"), ".csv");
  expect_error(scene("motion = { time = 0.1 }", "[[step]]\nrelease = true\n[film]\nframes = 3\n"),
               "the last step");
  expect_error(scene("motion = { time = 0.1 }", ""), "a motion in time", {"--method", "fem:1e-6"});
}

TEST_F(UnitFemScene, VolumesOfElementsNeedFiniteElementsAndKnownNames) {
  RUN_WHEN_SANITIZED();
  std::vector<std::string> arguments =
      stretch({"--elements", "von_mises=" + (m_folder / "m.nrrd")});
  arguments[5] = "ecm";
  Outcome outcome = run_supple(arguments);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.err.find("--elements: found no step of finite elements"), std::string::npos)
      << outcome.err;
  outcome = run_supple(stretch({"--elements", "mises=" + (m_folder / "m.nrrd")}));
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_NE(outcome.err.find("von_mises"), std::string::npos) << outcome.err;
  outcome = run_supple(stretch({"--elements", "von_mises"}));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("QUANTITY=FILE"), std::string::npos) << outcome.err;
}
