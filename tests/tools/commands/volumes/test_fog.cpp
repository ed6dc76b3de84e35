// Densities for renderers: OpenVDB as a fog of 0 to 1, in metres, with velocities, read by
// pyopenvdb (skipped where python3-openvdb is not installed).
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "volumes/io/volume_writer.h"

using namespace supple;
using namespace supple::test;

namespace {

using Json = nlohmann::json;

// Left-handed: i to the right, j to posterior, k to superior.
const Geometry kFogGrid({14, 12, 10}, {5, -3, 2}, {Vec3d(-2, 0, 0), {0, 1.5, 0}, {0, 0, 2.5}});

constexpr const char* kFogScript = R"(
import json, pyopenvdb as vdb
grids, meta = vdb.readAll('fog.vdb')
said = {}
for grid in grids:
    scalar = grid.name == 'density'
    at = [grid.transform.indexToWorld((n, 0, 0)) for n in (0, 1)]
    values = [v.value for v in grid.citerOnValues()]
    said[grid.name] = {'background': grid.background if scalar else list(grid.background),
        'class': str(grid.gridClass), 'half': grid.saveFloatAsHalf, 'active': grid.activeVoxelCount(),
        'range': [min(values), max(values)] if scalar else None,
        'voxel': grid.transform.voxelSize(),
        'first': list(at[0]), 'second': list(at[1]),
        'mean': None if scalar else [sum(v[c] for v in values) / len(values) for c in range(3)]}
said['probe'] = [[list(grids[0].transform.indexToWorld(v.min)), v.value]
                 for v in grids[0].citerOnValues()][:1]
print(json.dumps(said))
)";

class Fog : public testing::Test {
 protected:
  void SetUp() override {
    write_volume(m_folder / "head.nrrd", kFogGrid, ValueType::int16, [](int k, float* out) {
      for (int n = 0; n < 14 * 12; ++n) {
        const int i = n % 14, j = n / 14;
        const bool is_in = i >= 3 && i < 11 && j >= 3 && j < 9 && k >= 2 && k < 8;
        out[n] = is_in ? float(200 * i) : -1024.0f;
      }
    });
  }
  Json judged() const {
    write_text(m_folder / "script.py", kFogScript);
    EXPECT_EQ(
        std::system(
            ("cd " + (m_folder / "") + " && /usr/bin/python3 script.py > out.json 2> log").c_str()),
        0)
        << read_text(m_folder / "log");
    return Json::parse(read_text(m_folder / "out.json"), nullptr, false);
  }
  static bool has_openvdb() {
    return std::system("/usr/bin/python3 -c 'import pyopenvdb' > /dev/null 2>&1") == 0;
  }
  void expect_refused(const std::vector<std::string>& arguments, int code,
                      const std::string& part) const {
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  }

  TemporaryFolder m_folder;
};

using InteropFog = Fog;
using FaultFog = Fog;

}  // namespace

TEST_F(InteropFog, AVolumeIsAFogInMetresThatIsNotMirrored) {
  if (!has_openvdb()) GTEST_SKIP() << "python3-openvdb is not installed";
  const Outcome outcome = run_supple({"convert", m_folder / "head.nrrd", m_folder / "fog.vdb",
                                      "--range", "1000,2000", "--scale", "0.001", "--half"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json density = judged()["density"];
  EXPECT_EQ(density["background"], 0);
  EXPECT_EQ(density["class"], "fog volume");
  EXPECT_EQ(density["half"], true);
  EXPECT_GT(density["range"][0].get<double>(), 0);
  EXPECT_EQ(density["range"][1], 1);
  EXPECT_EQ(density["active"], 5 * 6 * 6) << "i from 6 to 10, whose densities exceed 1000";
  EXPECT_NEAR(density["voxel"][0].get<double>(), 0.002, 1e-9);
  // Counted from the other end of i, so that x grows with it; places stay.
  EXPECT_NEAR(density["first"][0].get<double>(), (5 - 2 * 13) * 0.001, 1e-9);
  EXPECT_NEAR(density["second"][0].get<double>(), (5 - 2 * 12) * 0.001, 1e-9);
  const Json probe = judged()["probe"][0];
  const double i = (5 - probe[0][0].get<double>() * 1000) / 2;
  EXPECT_NEAR(probe[1].get<double>(), std::min(1.0, (200 * i - 1000) / 1000), 1e-3);
}

TEST_F(InteropFog, AStateHasTheVelocityOfItsDisplacement) {
  if (!has_openvdb()) GTEST_SKIP() << "python3-openvdb is not installed";
  write_text(m_folder / "m.toml",
             "active = [0, 3000]\nmax_length = [[0, 1.5]]\n"
             "min_length = [[0, 0.5]]\nshear = [[0, 0.5]]\n");
  ASSERT_EQ(run_supple({"deform", m_folder / "head.nrrd", "--material", m_folder / "m.toml",
                        "--grab", "3,3,2:10,8,7", "--by", "0,0.75,0", "-o", m_folder / "d.vdb"})
                .exit_code,
            0);
  const Outcome outcome =
      run_supple({"resample", m_folder / "d.vdb", "-o", m_folder / "fog.vdb", "--range", "0,2000",
                  "--scale", "0.001", "--velocity", "0.04"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json said = judged();
  EXPECT_EQ(said["v"]["active"], said["density"]["active"]);
  EXPECT_NEAR(said["v"]["mean"][1].get<double>(), 0.75e-3 / 0.04, 1e-5);
  EXPECT_NEAR(said["v"]["mean"][0].get<double>(), 0, 1e-6);
  EXPECT_EQ(said["v"]["first"], said["density"]["first"]);
}

TEST_F(FaultFog, VoxelsThatOpenVdbTakesForNothingAreRefused) {
  const Geometry micro({4, 4, 4}, {0, 0, 0}, {Vec3d(0.01, 0, 0), {0, 0.01, 0}, {0, 0, 0.01}});
  write_volume(m_folder / "micro.nrrd", micro, ValueType::uint8,
               [](int, float* out) { std::fill_n(out, 16, 7.0f); });
  expect_refused({"convert", m_folder / "micro.nrrd", m_folder / "m.vdb", "--range", "0,9",
                  "--scale", "0.001"},
                 3, "scale: found 0.001, voxels of 1e-05, expected at least 0.00144");
  EXPECT_FALSE(std::filesystem::exists(m_folder / "m.vdb"));
  EXPECT_EQ(run_supple({"convert", m_folder / "micro.nrrd", m_folder / "m.vdb", "--range", "0,9",
                        "--scale", "0.002"})
                .exit_code,
            0);
}

TEST_F(FaultFog, OtherFormatsAndStatesSayWhatTheyCannotHold) {
  const std::string head = m_folder / "head.nrrd", out = m_folder / "a.nrrd";
  expect_refused({"convert", head, out, "--range", "0,1000"}, 3, "range: found .nrrd");
  expect_refused({"convert", head, out, "--scale", "0.001"}, 3, "scale: found .nrrd");
  expect_refused({"convert", head, out, "--half"}, 3, "half: found .nrrd");
  expect_refused({"convert", head, m_folder / "a.vdb", "--range", "5,5"}, 3, "range");
  expect_refused(
      {"resample", head, "--spacing", "3,3,3", "-o", m_folder / "a.vdb", "--velocity", "1"}, 2,
      "--velocity for a volume");
  EXPECT_FALSE(std::filesystem::exists(out));
  EXPECT_FALSE(std::filesystem::exists(m_folder / "a.vdb"));
}
