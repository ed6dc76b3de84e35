// supple mesh: a volume or a label becomes a mesh file, with a report.
#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "volumes/io/mesh/triangle_mesh.h"
#include "volumes/io/solid/solid_mesh_file.h"

namespace supple::test {
namespace {

class UnitMesh : public ::testing::Test {
 protected:
  void SetUp() override { write_ball(m_folder, "ball", 24); }
  std::string at(const std::string& name) const { return m_folder / name; }

  TemporaryFolder m_folder;
};
using FaultMesh = UnitMesh;

}  // namespace

TEST_F(UnitMesh, TellsAnglesVolumeAndSurfaceOfAVolumesTetrahedra) {
  const Outcome outcome =
      run_supple({"mesh", at("ball.nhdr"), "--elements", "5000", "--json", "-o", at("ball.vtu")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto report = nlohmann::json::parse(outcome.out);
  EXPECT_GE(report["least_dihedral_deg"], 10.7);
  EXPECT_LE(report["largest_dihedral_deg"], 164.8);
  EXPECT_NEAR(report["volume_ml"].get<double>() / report["voxels_ml"].get<double>(), 1, 2e-3);
  EXPECT_NEAR(report["tetrahedra"].get<double>(), 5000, 1500);
  EXPECT_EQ(report["open_edges"], 0);
  EXPECT_EQ(report["pieces"], 1);
  EXPECT_EQ(report["turned_inside_out"], 0);
  const SolidMesh mesh = read_solid_mesh(at("ball.vtu"));
  EXPECT_EQ(mesh.tets.size(), report["tetrahedra"].get<std::size_t>());
  EXPECT_EQ(mesh.nodes_lps_mm.size(), report["nodes"].get<std::size_t>());
}

TEST_F(UnitMesh, WritesSeveralFormatsAndTheSurfaceAtOnce) {
  const Outcome outcome =
      run_supple({"mesh", at("ball.nhdr"), "--spacing", "3", "-o", at("ball.inp"), "-o",
                  at("ball.ply"), "-o", at("ball.feb"), "-o", at("ball.msh")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("dihedral angles"), std::string::npos) << outcome.out;
  const SolidMesh mesh = read_solid_mesh(at("ball.inp"));
  ASSERT_EQ(mesh.faces.size(), 1u);
  EXPECT_EQ(read_mesh(at("ball.ply")).triangles.size(), mesh.faces[0].triangles.size());
  EXPECT_TRUE(std::filesystem::exists(at("ball.feb")));
  EXPECT_TRUE(std::filesystem::exists(at("ball.msh")));
}

TEST_F(UnitMesh, ElementsHaveTheStiffnessOfTheirDensitiesAsHexahedraToo) {
  write_soft_material(at("material.toml"));
  write_text(at("material.toml"), read_text(at("material.toml")) +
                                      "stiffness = [[0, 5], [255, 50]]\npoisson = [[0, 0.4]]\n");
  for (const std::vector<std::string>& kind :
       {std::vector<std::string>{"--spacing", "3"}, {"--hex", "2"}}) {
    std::vector<std::string> arguments = {
        "mesh",   at("ball.nhdr"), "--material", at("material.toml"), "--bins", "5",
        "--json", "--force",       "-o",         at("ball.inp")};
    arguments.insert(arguments.end(), kind.begin(), kind.end());
    const Outcome outcome = run_supple(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto report = nlohmann::json::parse(outcome.out);
    EXPECT_LE(report["materials"], 5);
    EXPECT_GE(report["young_kpa"][0], 5);
    EXPECT_LE(report["young_kpa"][1], 50);
    const SolidMesh mesh = read_solid_mesh(at("ball.inp"));
    EXPECT_EQ(mesh.hexes.empty(), kind[0] != "--hex");
    EXPECT_EQ(mesh.materials.size(), report["materials"].get<std::size_t>());
    EXPECT_NEAR(mesh.materials[0].poisson, 0.4, 1e-9);
  }
}

TEST_F(UnitMesh, SeveralLabelsBecomeRegionsThatShareFaces) {
  std::string bytes;
  for (int n = 0; n < 16 * 16 * 16; ++n) {
    const int i = n % 16;
    bytes += char(i < 2 || i > 13 ? 0 : i < 8 ? 3 : 8);
  }
  write_text(at("labels.raw"), bytes);
  write_text(at("labels.nhdr"),
             "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 16 16 16\nencoding: raw\n"
             "space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
             "space origin: (0,0,0)\ndata file: labels.raw\n");
  const Outcome outcome = run_supple({"mesh", at("labels.nhdr"), "--label", "all", "--spacing", "2",
                                      "--json", "-o", at("labels.inp")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto report = nlohmann::json::parse(outcome.out);
  for (const char* label : {"3", "8"}) {
    const auto& region = report["regions"][label];
    EXPECT_NEAR(region["volume_ml"].get<double>() / region["voxels_ml"].get<double>(), 1, 0.1);
  }
  std::vector<std::string> names;
  for (const FaceSet& faces : read_solid_mesh(at("labels.inp")).faces) names.push_back(faces.name);
  EXPECT_EQ(names, (std::vector<std::string>{"region_3", "region_3_to_region_8", "region_8"}));
  const Outcome one = run_supple({"mesh", at("labels.nhdr"), "--label", "8", "--label", "4",
                                  "--spacing", "2", "-o", at("four.vtu")});
  EXPECT_EQ(one.exit_code, 3);
  EXPECT_NE(one.err.find("--label: found 4, which no voxel has"), std::string::npos) << one.err;
}

TEST_F(FaultMesh, BadChoicesAreToldInOneLine) {
  const auto expect = [&](const std::vector<std::string>& options, int exit_code,
                          const std::string& part) {
    std::vector<std::string> all = {"mesh", at("ball.nhdr")};
    all.insert(all.end(), options.begin(), options.end());
    const Outcome outcome = run_supple(all);
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  };
  expect({"-o", at("ball.stp")}, 3, "expected .vtu, .inp, .feb, .msh");
  expect({"--spacing", "100", "-o", at("a.vtu")}, 3, "spacing: found 100 mm");
  expect({"--spacing", "-2", "-o", at("a.vtu")}, 3, "--spacing: found -2");
  expect({"--range", "1,2", "--label", "3", "-o", at("a.vtu")}, 2, "found --range and --label");
  expect({"--label", "brain", "-o", at("a.vtu")}, 3, "--label: found brain");
  expect({"--label", "all", "--components", "1", "-o", at("a.vtu")}, 2, "several labels");
  expect({"--hex", "2", "--smooth", "0", "-o", at("a.vtu")}, 2, "found --hex and --smooth");
  expect({"--hex", "3", "-o", at("a.vtu")}, 3, "expected 1, 2, 4 … 64 voxels");
  expect({"--bins", "4", "-o", at("a.vtu")}, 2, "found --bins without --material");
  expect({"--range", "5000,6000", "-o", at("a.vtu")}, 3, "ball.nhdr");
}

TEST_F(FaultMesh, AllLabelsOfAVolumeOfDensitiesAreRefused) {
  for (const auto& [value, told] : {std::pair(2.5F, "2.5"), {-3.0F, "-3"}, {70000.0F, "70000"}}) {
    const float values[8] = {0, 1, 2, 2, value, 2, 2, 2};
    write_text(at("d.raw"), std::string(reinterpret_cast<const char*>(values), sizeof values));
    write_text(at("d.nhdr"),
               "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nencoding: raw\nendian: little\n"
               "space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
               "space origin: (0,0,0)\ndata file: d.raw\n");
    const Outcome outcome =
        run_supple({"mesh", at("d.nhdr"), "--label", "all", "--hex", "1", "-o", at("d.vtu")});
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    EXPECT_NE(outcome.err.find("--label all: found the value " + std::string(told)),
              std::string::npos)
        << outcome.err;
  }
}

}  // namespace supple::test
