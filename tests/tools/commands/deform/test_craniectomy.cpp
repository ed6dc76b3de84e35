// The scene of docs/studies/craniectomy.md on a phantom: a ball of tissue that swells in a shell,
// which is closed or has an opening.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/base/vec.h"
#include "volumes/io/load/load.h"

using namespace supple;
using namespace supple::test;

namespace {

using Json = nlohmann::json;

constexpr int kHeadSize = 20, kBrain = 100, kSkull = 200;
constexpr double kVoxelMl = 8e-3;
constexpr double kSwellingKpa = 0.5, kBulkKpa = 6 / (3 * (1 - 2 * 0.4));

constexpr double kBrainRadius = 7, kSkullRadius = 9.4;

Vec3i voxel_of(int n) {
  return {n % kHeadSize, n / kHeadSize % kHeadSize, n / (kHeadSize * kHeadSize)};
}

/// Distance to the middle, in voxels of 2 mm.
double radius_of(const Vec3i& voxel) {
  return (Vec3d(voxel) - Vec3d((kHeadSize - 1) / 2.0)).length();
}

class UnitCraniectomy : public ::testing::Test {
 protected:
  UnitCraniectomy() {
    std::string voxels;
    for (int n = 0; n < kHeadSize * kHeadSize * kHeadSize; ++n) {
      const double r = radius_of(voxel_of(n));
      voxels += char(static_cast<unsigned char>(r < kBrainRadius   ? kBrain
                                                : r < kSkullRadius ? kSkull
                                                                   : 0));
    }
    write_text(m_folder / "head.raw", voxels);
    write_text(m_folder / "head.nhdr",
               "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 20 20 20\nspace directions: (2,0,0) (0,2,0) (0,0,2)\n"
               "space origin: (0,0,0)\nencoding: raw\ndata file: head.raw\n");
  }

  /// A scene whose step begins with these lines.
  std::string scene(const std::string& step,
                    const std::string& brain = "grab_density = [50, 150]") {
    const std::string path = m_folder / "scene.toml";
    write_text(
        path,
        "[volume]\npath = \"head.nhdr\"\n[material]\ndomain = [0, 255]\n"
        "active = [1, 255]\nmax_length = [[0, 1.5]]\nmin_length = [[0, 0.6]]\n"
        "shear = [[0, 0.25]]\nstiffness = [[0, 6]]\npoisson = [[0, 0.4]]\n[[step]]\n" +
            step +
            "fix_density = [150, 255]\nmodel = \"fem\"\n"
            "fem = { swellings = [{ pressure_kpa = 0.5, " +
            brain +
            " }] }\n[output]\nstate = \"state.vdb\"\n"
            "elements = { pressure = \"pressure.nrrd\", volume_strain = \"growth.nrrd\" }\n");
    return path;
  }

  /// The report of the step of a scene that runs.
  Json step_of(const std::string& scene) {
    const Outcome run = run_supple({"run", scene, "-o", m_folder / "out", "--json", "--force"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.exit_code == 0 ? Json::parse(run.out).at("steps").at(0) : Json();
  }

  static std::vector<Vec3i> brain_voxels() {
    std::vector<Vec3i> voxels;
    for (int n = 0; n < kHeadSize * kHeadSize * kHeadSize; ++n) {
      const Vec3i voxel = voxel_of(n);
      if (radius_of(voxel) < kBrainRadius) voxels.push_back(voxel);
    }
    return voxels;
  }

  /// The mean over the brain of a volume of values.
  double mean_of(const std::string& name) {
    const Volume volume = load_volume(m_folder / ("out/" + name));
    double sum = 0;
    for (const Vec3i& voxel : brain_voxels()) sum += double(volume.density.at(voxel));
    return sum / double(brain_voxels().size());
  }

  TemporaryFolder m_folder;
};

}  // namespace

TEST_F(UnitCraniectomy, InAClosedSkullNothingMovesAndThePressureIsThatOfTheSwelling) {
  RUN_WHEN_SANITIZED();
  const Json step = step_of(scene(""));
  ASSERT_FALSE(step.is_null());
  EXPECT_FALSE(step.contains("removed"));
  EXPECT_NEAR(step.at("fem").at("volume_change_ml").get<double>(), 0, 1e-9);
  EXPECT_NEAR(step.at("fem").at("smallest_det_f").get<double>(), 1, 1e-9);
  EXPECT_NEAR(mean_of("pressure.nrrd"), kSwellingKpa, 1e-6);
}

TEST_F(UnitCraniectomy, OfAnOpenedSkullAsMuchComesOutAsTheBrainGrewAndThePressureFalls) {
  RUN_WHEN_SANITIZED();
  const Json step = step_of(
      scene("remove = [{ grab_ball = [9.5, 9.5, 18], radius = 9, grab_density = [150, 255] }]\n"));
  ASSERT_FALSE(step.is_null());
  EXPECT_GT(step.at("removed"), 100);
  const double brain_ml = double(brain_voxels().size()) * kVoxelMl;
  const double out_ml = step.at("fem").at("volume_change_ml");
  EXPECT_GT(out_ml, 0.05);
  EXPECT_NEAR(out_ml, mean_of("growth.nrrd") * brain_ml, 1e-4 * out_ml);
  EXPECT_NEAR(2 * step.at("fem").at("energy_mj").get<double>(), kSwellingKpa * out_ml,
              1e-4 * kSwellingKpa * out_ml);
  EXPECT_NEAR(mean_of("pressure.nrrd"), kSwellingKpa - kBulkKpa * out_ml / brain_ml, 1e-4);
  // Outwards at the opening, and nowhere else.
  const auto way = [&](const char* voxel) {
    const Outcome probe =
        run_supple({"probe", m_folder / "out/state.vdb", "--at", voxel, "--json"});
    return Json::parse(probe.out).at("places").at(0).at("displacement_mm").at(2).get<double>();
  };
  EXPECT_GT(way("9,9,16"), 0.2);
  EXPECT_NEAR(way("9,9,3"), 0, 0.02);
}

TEST_F(UnitCraniectomy, AMisspeltKeyOfALoadIsTheOneThatIsNamed) {
  for (const auto& [key, misspelt] : {std::pair("pressure_kpa", "presure_kpa"),
                                      std::pair("grab_density = [50", "grab_densty = [50")}) {
    const std::string path = scene("");
    std::string text = read_text(path);
    text.replace(text.find(key), std::string(key).size(), misspelt);
    write_text(path, text);
    const Outcome run = run_supple({"run", path, "--dry-run"});
    EXPECT_EQ(run.exit_code, 3);
    const std::string name = std::string(misspelt).substr(0, std::string(misspelt).find(' '));
    EXPECT_NE(run.err.find("swellings[1]." + name + ": found an unknown key"), std::string::npos)
        << run.err;
  }
}

TEST_F(UnitCraniectomy, ADryRunFindsPartsThatAreNotThere) {
  RUN_WHEN_SANITIZED();
  const struct {
    const char *step, *brain, *role;
  } wrong[] = {{"remove = [{ piece_at = [0, 0, 0] }]\n", "grab_density = [50, 150]", "remove"},
               {"remove = [{ grab_density = [230, 255] }]\n", "grab_density = [50, 150]", "remove"},
               {"", "piece_at = [10, 10, 18], grab_density = [50, 150]", "swelling"}};
  for (const auto& [step, brain, role] : wrong) {
    const std::string path = scene(step, brain);
    const Outcome run = run_supple({"run", path, "-o", m_folder / "out"});
    const Outcome dry = run_supple({"run", path, "--dry-run"});
    EXPECT_NE(run.exit_code, 0);
    EXPECT_EQ(dry.exit_code, run.exit_code);
    EXPECT_EQ(dry.err, run.err);
    EXPECT_NE(run.err.find(role), std::string::npos) << run.err;
  }
}
