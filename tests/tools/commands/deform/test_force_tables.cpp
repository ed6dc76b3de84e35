// Forces of steps as a table, and those on shapes in contact.
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "volumes/io/volume_writer.h"

using namespace supple;
using namespace supple::test;

namespace {

/// A bar of 10 x 4 x 4 voxels of 2 mm, held at one end.
class ForceTables : public testing::Test {
 protected:
  void SetUp() override {
    const Geometry grid({12, 6, 6}, {0, 0, 0}, {Vec3d(2, 0, 0), {0, 2, 0}, {0, 0, 2}});
    write_volume(m_folder / "bar.nrrd", grid, ValueType::uint8, [](int k, float* out) {
      for (int n = 0; n < 12 * 6; ++n) {
        const int i = n % 12, j = n / 12;
        out[n] = i > 0 && i < 11 && j > 0 && j < 5 && k > 0 && k < 5 ? 100.0f : 0.0f;
      }
    });
    write_text(m_folder / "m.toml",
               "active = [50, 200]\nmax_length = [[0, 1.5]]\nmin_length = [[0, 0.5]]\n"
               "shear = [[0, 0.5]]\nstiffness = [[0, 10]]\npoisson = [[0, 0.0]]\n"
               "density = [[0, 1000]]\n");
  }
  nlohmann::json run(const std::string& steps) const {
    write_text(m_folder / "scene.toml",
               "[volume]\npath = \"bar.nrrd\"\n[material]\ntable = \"m.toml\"\n" + steps +
                   "[output]\nforces = \"forces.csv\"\n");
    const Outcome outcome =
        run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "", "--force", "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out, nullptr, false);
  }
  /// Cells of the table, the head left out.
  std::vector<std::vector<std::string>> rows() const {
    std::istringstream text(read_text(m_folder / "forces.csv"));
    std::vector<std::vector<std::string>> rows;
    std::string line;
    std::getline(text, line);
    EXPECT_EQ(line.substr(0, 25), "step,holder,name,way_x_mm");
    while (std::getline(text, line)) {
      std::istringstream cells(line);
      rows.emplace_back();
      for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
    }
    return rows;
  }

  TemporaryFolder m_folder;
};

using UnitForceTables = ForceTables;

}  // namespace

TEST_F(UnitForceTables, AStretchedBarHasARowPerStepWithWayAndForce) {
  std::string steps;
  for (int step = 1; step <= 3; ++step) {
    steps +=
        "[[step]]\nmodel = \"fem\"\nfix = [[1, 1, 1, 1, 4, 4]]\ngrab_box = [10, 1, 1, 10, 4, "
        "4]\nby = [0.1, 0, 0]\n";
  }
  const nlohmann::json json = run(steps);
  const auto table = rows();
  ASSERT_EQ(table.size(), 3u);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_EQ(table[n][0], std::to_string(n + 1));
    // The name has commas, so that cells are counted from the end.
    const std::size_t cells = table[n].size();
    EXPECT_NEAR(std::stod(table[n][cells - 9]), 0.1 * double(n + 1), 1e-9) << "the way so far";
    const double force = std::stod(table[n][cells - 6]);
    EXPECT_NEAR(force, json["steps"][n]["reactions"][0]["force_n"][0].get<double>(), 1e-5);
    // E A u / L of the eight free layers between the held ones: 10 kPa, 64 mm2, 16 mm.
    const double expected = -10e-3 * 64 * 0.1 * double(n + 1) / 16;
    EXPECT_NEAR(force / expected, 1, 0.02);
  }
}

TEST_F(UnitForceTables, APlaneBearsTheWeightOfABodyAtRestOnIt) {
  // 160 voxels of 8 mm3 and 1000 kg/m3 weigh 12.6 mN; mass damping lets the bar come to rest.
  const nlohmann::json json = run(
      "[[step]]\nmodel = \"springs\"\n[step.springs]\ntime = 1.5\nstep = 0.002\n"
      "mass_damping = 30\ngravity = [0, 0, -9.81]\n[[step.springs.contact]]\nplane = { point = [0, "
      "0, 1], normal = [0, 0, 1] }\n");
  const double weight_n = 160 * 8e-9 * 1000 * 9.81;
  const auto force = json["steps"][0]["contact_forces_n"][0];
  EXPECT_NEAR(force[2].get<double>() / -weight_n, 1, 0.02);
  EXPECT_NEAR(force[0].get<double>(), 0, 0.01 * weight_n);
  const auto table = rows();
  ASSERT_EQ(table.size(), 1u);
  EXPECT_EQ(table[0][1], "contact 1");
  EXPECT_NEAR(std::stod(table[0][8]), force[2].get<double>(), 1e-7);
}

TEST_F(UnitForceTables, LoadsOfTheCommandLineAreThoseOfScenes) {
  // 10 kPa over 64 mm2, no lateral strain: 8 free layers of 2 mm stretch by 0.01, and half of the
  // last one by half of that, since its elements share the force.
  const std::vector<std::string> deform = {"deform",     m_folder / "bar.nrrd",
                                           "--material", m_folder / "m.toml",
                                           "--model",    "fem",
                                           "--fix",      "1,1,1:1,4,4",
                                           "--force",    "--json",
                                           "-o",         m_folder / "d.vdb"};
  const auto longest = [&](const std::string& load) {
    std::vector<std::string> arguments = deform;
    arguments.insert(arguments.end(), {"--load", load});
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const Outcome metrics = run_supple({"metrics", m_folder / "d.vdb", "--json"});
    return nlohmann::json::parse(metrics.out)["max_mm"].get<double>();
  };
  EXPECT_NEAR(longest("{ grab_box = [10, 1, 1, 10, 4, 4], force_n = [0.0064, 0, 0] }"), 0.165,
              1e-3);
  EXPECT_NEAR(
      longest("{ grab_box = [10, 1, 1, 10, 4, 4], pressure_kpa = -0.1, facing = [1, 0, 0] }"), 0.17,
      1e-3);
  std::vector<std::string> wrong = deform;
  wrong.insert(wrong.end(), {"--load", "{ grab_box = [10, 1, 1, 10, 4, 4] }"});
  const Outcome outcome = run_supple(wrong);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("--load"), std::string::npos) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
}
