// Finite elements on tetrahedra in scenes: voxels follow the mesh, loads, openings, sheets, a shell
// and labels, and what is refused.
#include <functional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/io/load/load.h"
#include "volumes/io/warp_file.h"

using namespace supple;
using namespace supple::test;

namespace {

using nlohmann::json;

constexpr Vec3i kDims(12, 12, 24);

/// A bar of voxels of 1 mm, whose lower half has label 1 and density 100, the upper 2 and 50.
class UnitTetScene : public ::testing::Test {
 protected:
  UnitTetScene() {
    write_volume("bar", [](const Vec3i& v) { return v.z < 12 ? 100 : 50; });
    write_volume("labels", [](const Vec3i& v) { return v.z < 12 ? 1 : 2; });
    write_material("0.3");
  }

  void write_material(const std::string& poisson) {
    write_text(m_folder / "tissue.toml",
               "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 1.5]]\n"
               "min_length = [[0, 0.6]]\nshear = [[0, 0.25]]\nstiffness = [[0, 20]]\n"
               "density = [[0, 1000]]\npoisson = [[0, " +
                   poisson + "]]\n");
  }

  void write_volume(const std::string& name, const std::function<int(const Vec3i&)>& value) {
    std::string voxels;
    for (int k = 0; k < kDims.z; ++k) {
      for (int j = 0; j < kDims.y; ++j) {
        for (int i = 0; i < kDims.x; ++i) voxels += char(value({i, j, k}));
      }
    }
    write_text(m_folder / (name + ".raw"), voxels);
    write_text(m_folder / (name + ".nhdr"),
               "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 12 12 24\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
               "space origin: (0,0,0)\nencoding: raw\ndata file: " +
                   name + ".raw\n");
  }

  /// A run of one step with these keys and these of `tets`.
  Outcome run(const std::string& keys, const std::string& tets, const std::string& after = "",
              const std::vector<std::string>& more = {}) {
    const bool is_made = tets.rfind("mesh", 0) != 0;
    write_text(m_folder / "scene.toml",
               "[volume]\npath = \"bar.nhdr\"\n[labels]\npath = \"labels.nhdr\"\n[material]\n"
               "table = \"tissue.toml\"\n[[step]]\nmodel = \"tets\"\n" +
                   keys + "\n[step.tets]\n" + (is_made ? "smooth = 0\n" : "") + tets + "\n" +
                   after);
    std::vector<std::string> words = {
        "run", m_folder / "scene.toml", "-o", m_folder / "out", "--json", "--force"};
    words.insert(words.end(), more.begin(), more.end());
    return run_supple(words);
  }

  json step(const std::string& keys, const std::string& tets, const std::string& after = "",
            const std::vector<std::string>& more = {}) {
    const Outcome outcome = run(keys, tets, after, more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.exit_code == 0 ? json::parse(outcome.out)["steps"].back() : json();
  }

  /// The one line that refuses the step.
  std::string refusal(const std::string& keys, const std::string& tets) {
    const Outcome outcome = run(keys, tets);
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    return outcome.err.substr(outcome.err.find("error:"));
  }

  const std::string m_held = "fix = [[0, 0, 0, 11, 11, 1]]\n";
  TemporaryFolder m_folder;
};

/// The displacement in mm of a voxel of the state.
Vec3d displacement_at(const TemporaryFolder& folder, const Vec3i& voxel) {
  const Outcome probe = run_supple(
      {"probe", folder / "out/state.vdb", "--at",
       std::to_string(voxel.x) + "," + std::to_string(voxel.y) + "," + std::to_string(voxel.z),
       "--json"});
  EXPECT_EQ(probe.exit_code, 0) << probe.err;
  const json u = json::parse(probe.out)["places"][0]["displacement_mm"];
  return {u[0], u[1], u[2]};
}

}  // namespace

TEST_F(UnitTetScene, ATurnOfBothEndsTurnsEveryVoxelByIt) {
  const std::string turned =
      "handles = [{ grab_box = [0, 0, 0, 11, 11, 2], rotate = 0.5, axis = [0, 1, 0], about = [5.5, "
      "5.5, 11.5] }, { grab_box = [0, 0, 21, 11, 11, 23], rotate = 0.5, axis = [0, 1, 0], about = "
      "[5.5, 5.5, 11.5] }]\n";
  const json found = step(turned, "spacing = 3", "[output]\nstate = \"state.vdb\"\n");
  ASSERT_FALSE(found.is_null());
  // Linear theory takes 1 - cos of the angle for a strain, here of 4e-5.
  const double angle = 0.5 * 3.14159265358979 / 180;
  for (const Vec3i& v : {Vec3i(0, 0, 0), Vec3i(11, 11, 23), Vec3i(5, 6, 12), Vec3i(0, 5, 8)}) {
    const double x = v.x - 5.5, z = v.z - 11.5;
    const Vec3d u = displacement_at(m_folder, v);
    EXPECT_NEAR(u.x, (std::cos(angle) - 1) * x + std::sin(angle) * z, 1e-3) << v;
    EXPECT_NEAR(u.y, 0, 1e-3) << v;
    EXPECT_NEAR(u.z, (std::cos(angle) - 1) * z - std::sin(angle) * x, 1e-3) << v;
  }
  EXPECT_EQ(found["tets"]["unmeshed_voxels"], 0);
}

TEST_F(UnitTetScene, ForcesAndWeightArriveAtTheAnchors) {
  const json pulled = step(
      m_held,
      "spacing = 3\nforces = [{ grab_box = [0, 0, 20, 11, 11, 23], force_n = [0.01, 0, 0.02] }]");
  EXPECT_NEAR(pulled["fem"]["anchor_force_n"][0], 0.01, 1e-7);
  EXPECT_NEAR(pulled["fem"]["anchor_force_n"][2], 0.02, 1e-7);
  const json heavy = step(m_held, "spacing = 3\ngravity = [0, 0, -10]");
  const double kg = 1e-6 * double(heavy["tets"]["mesh_ml"]);
  EXPECT_NEAR(heavy["fem"]["anchor_force_n"][2], -10e3 * kg, 1e-6);
  const json pressed = step(m_held,
                            "spacing = 3\npressures = [{ grab_box = [0, 0, 23, 11, 11, "
                            "23], facing = [0, 0, 1], pressure_kpa = 0.5 }]");
  // 144 mm^2, of which the edges' faces may be left out.
  EXPECT_NEAR(pressed["fem"]["anchor_force_n"][2], -0.5 * 144e-3, 0.15 * 0.5 * 144e-3);
}

TEST_F(UnitTetScene, WhatSwellsLeavesThroughItsOpening) {
  const std::string opening = "openings = [{ name = \"top\", toward = [0, 0, 1], degrees = 28 }]\n";
  const std::string swells = "swellings = [{ grab_density = [0, 255], pressure_kpa = 1 }]\n";
  const std::string held = "spacing = 2\noutside = \"held\"\n";
  const json open = step("", held + opening + swells);
  const json& top = open["tets"]["openings"][0];
  EXPECT_EQ(top["name"], "top");
  EXPECT_NEAR(top["area_mm2"], 144, 25);  // without the edges' faces
  EXPECT_GT(top["out_ml"], 0.005);
  EXPECT_NEAR(top["out_ml"], open["fem"]["volume_change_ml"], 1e-9);
  EXPECT_NEAR(open["tets"]["voxels_ml"], 12 * 12 * 24e-3, 1e-9);

  // The pressure that is left: 1 kPa less K times the volume that came out.
  const double bulk_kpa = 20 / (3 * (1 - 0.6));
  EXPECT_NEAR(open["tets"]["mean_pressure_kpa"],
              1 - bulk_kpa * double(top["out_ml"]) / double(open["tets"]["mesh_ml"]), 2e-3);

  const json closed = step("", held + opening + swells +
                                   "sheets = [{ faces = \"top\", stiffness = 20000, thickness = "
                                   "0.5, poisson = 0.3 }]\n");
  EXPECT_LT(closed["tets"]["openings"][0]["out_ml"], 0.7 * double(top["out_ml"]));

  // A part of the body names the same faces as an angle does.
  const json by_part = step("", held + swells +
                                    "openings = [{ name = \"top\", grab_box = [0, 0, 23, 11, 11, "
                                    "23] }]\n");
  EXPECT_NEAR(by_part["tets"]["openings"][0]["area_mm2"], 144, 40);
}

TEST_F(UnitTetScene, AShellKeepsTheBodyInAndLetsItPart) {
  const std::string keys =
      "spacing = 2\noutside = \"shell\"\nopenings = [{ name = \"top\", toward = "
      "[0, 0, 1], degrees = 28 }]\n";
  const json out =
      step(m_held, keys + "swellings = [{ grab_density = [0, 255], pressure_kpa = 0.3 }]\n");
  const json& shell = out["tets"]["shell"];
  EXPECT_GT(shell["pressing"], 50);
  EXPECT_LE(shell["deepest_mm"], 1e-3);
  EXPECT_LE(shell["force_balance"], 1e-5);
  EXPECT_LT(out["tets"]["openings"][0]["free_area_mm2"],
            double(out["tets"]["openings"][0]["area_mm2"]));
  const json in =
      step(m_held, keys + "swellings = [{ grab_density = [0, 255], pressure_kpa = -0.3 }]\n");
  EXPECT_LT(in["tets"]["shell"]["pressing"], int(shell["pressing"]) / 4);
  EXPECT_LT(in["fem"]["volume_change_ml"], 0);
}

TEST_F(UnitTetScene, ASheetBetweenLabelsHoldsTheirBorder) {
  const auto twist = [&](const std::string& more) {
    return step(m_held,
                "spacing = 2\nlabels = true\nforces = [{ grab_box = [0, 0, 10, 11, 11, 13], "
                "force_n = [0, 0, 0.05] }]\n" +
                    more,
                "[output]\nstate = \"state.vdb\"\nelements = { von_mises = \"m.nrrd\" }\n");
  };
  const json free = twist("");
  ASSERT_FALSE(free.is_null());
  EXPECT_EQ(free["fem"]["gauges"].size(), 2u);
  EXPECT_EQ(free["fem"]["gauges"][0]["elements"], 12 * 12 * 12);
  const Volume stress = load_volume(m_folder / "out/m.nrrd");
  EXPECT_GT(stress.density.at({5, 5, 5}), 0);
  const json stiff =
      twist("sheets = [{ between = [1, 2], stiffness = 1e6, thickness = 1, poisson = 0.3 }]\n");
  EXPECT_LT(stiff["fem"]["energy_mj"], 0.999 * double(free["fem"]["energy_mj"]));
}

TEST_F(UnitTetScene, AHandleSmallerThanTheMeshIsFollowedExactly) {
  const json found = step(m_held + "handles = [{ grab = [6, 6, 20], by = [0.5, 0, 0.25] }]\n",
                          "spacing = 4", "[output]\nstate = \"state.vdb\"\n");
  const Vec3d u = displacement_at(m_folder, {6, 6, 20});
  EXPECT_NEAR(u.x, 0.5, 1e-4);
  EXPECT_NEAR(u.z, 0.25, 1e-4);
  const Vec3d beside = displacement_at(m_folder, {6, 6, 21});
  EXPECT_NEAR(beside.x, 0.5, 0.25);
  EXPECT_EQ(found["reactions"].size(), 1u);
  EXPECT_LT(found["reactions"][0]["force_n"][0], 0);
}

TEST_F(UnitTetScene, ThreadsAndTenNodesAgree) {
  RUN_WHEN_SANITIZED();
  const std::string pull =
      m_held + "handles = [{ grab_box = [0, 0, 22, 11, 11, 23], by = [1, 0, 0] }]\n";
  const json one = step(pull, "spacing = 3", "", {"--threads", "1"});
  const json five = step(pull, "spacing = 3", "", {"--threads", "5"});
  EXPECT_EQ(one["reactions"], five["reactions"]);
  const json ten = step(pull, "spacing = 3\nelement = \"quadratic\"");
  const json exact = step(pull, "spacing = 3\nequations = \"factor\"");
  const double force = one["reactions"][0]["force_n"][0];
  EXPECT_NEAR(ten["reactions"][0]["force_n"][0], force, 0.15 * std::abs(force));
  EXPECT_NEAR(exact["reactions"][0]["force_n"][0], force, 1e-4 * std::abs(force));
}

TEST_F(UnitTetScene, AMeshOfAFileIsTheOneThatWasWritten) {
  RUN_WHEN_SANITIZED();
  const Outcome meshed = run_supple({"mesh", m_folder / "bar.nhdr", "--range", "1,255", "--spacing",
                                     "3", "--smooth", "0", "-o", m_folder / "bar.vtu"});
  ASSERT_EQ(meshed.exit_code, 0) << meshed.err;
  const std::string keys =
      m_held + "handles = [{ grab_box = [0, 0, 22, 11, 11, 23], by = [1, 0, 0] }]\n";
  const json own = step(keys, "spacing = 3");
  const json read = step(keys, "mesh = \"bar.vtu\"");
  EXPECT_EQ(read["tets"]["tetrahedra"], own["tets"]["tetrahedra"]);
  EXPECT_NEAR(read["reactions"][0]["force_n"][0], double(own["reactions"][0]["force_n"][0]), 1e-7);
}

TEST_F(UnitTetScene, ACutBetweenLabelsPartsTheMeshThere) {
  const std::string pull =
      m_held + "handles = [{ grab_box = [0, 0, 22, 11, 11, 23], by = [0, 0, 2] }]\n";
  const std::string cut = "cut = [{ label = 2, from = 1 }]\n", mesh = "spacing = 2\nlabels = true";
  const std::string state = "[output]\nstate = \"state.vdb\"\n";
  const json whole = step(pull, mesh, state);
  EXPECT_LT(displacement_at(m_folder, {5, 5, 12}).z, 1.5);
  const json parted = step(pull + cut, mesh, state);
  for (const int ij : {0, 6, 11}) {
    EXPECT_NEAR(displacement_at(m_folder, {ij, ij, 11}).z, 0, 1e-3) << ij;
    EXPECT_NEAR(displacement_at(m_folder, {ij, ij, 12}).z, 2, 1e-3) << ij;
  }
  EXPECT_EQ(parted["cut_links"], 144);
  EXPECT_EQ(parted["tets"]["outer_faces"], whole["tets"]["outer_faces"]);
  EXPECT_GT(parted["tets"]["nodes"], int(whole["tets"]["nodes"]) + 20);
  EXPECT_NEAR(parted["reactions"][0]["force_n"][2], 0, 1e-6);
}

TEST_F(UnitTetScene, VoxelsBesideACutGoWithTheirOwnBankWhereTheMeshHasSteps) {
  const auto is_upper = [](const Vec3i& v) { return 2 * v.x + 3 * v.z >= 45; };
  write_volume("labels", [&](const Vec3i& v) { return is_upper(v) ? 2 : 1; });
  ASSERT_EQ(run_supple({"mesh", m_folder / "bar.nhdr", "--range", "1,255", "--spacing", "4", "-o",
                        m_folder / "bar.vtu"})
                .exit_code,
            0);
  step(m_held +
           "handles = [{ grab_box = [0, 0, 22, 11, 11, 23], by = [0, 0, 2] }]\n"
           "cut = [{ label = 2, from = 1 }]\n",
       "mesh = \"bar.vtu\"\nlabels = true", "[output]\nstate = \"state.vdb\"\n");
  for (int i = 0; i < kDims.x; i += 2) {
    int k = 0;
    while (!is_upper({i, 5, k})) ++k;
    EXPECT_NEAR(displacement_at(m_folder, {i, 5, k - 1}).z, 0, 1e-3) << i;
    EXPECT_NEAR(displacement_at(m_folder, {i, 5, k}).z, 2, 1e-3) << i;
  }
}

TEST_F(UnitTetScene, FiniteStrainTurnsAsFarAsItsHandles) {
  RUN_WHEN_SANITIZED();
  const std::string turned =
      m_held +
      "handles = [{ grab_box = [0, 0, 22, 11, 11, 23], rotate = 40, axis = [0, 0, 1], "
      "about = [5.5, 5.5, 22] }]\n";
  const json linear = step(turned, "spacing = 3");
  const json finite = step(turned, "spacing = 3\nstrain = \"finite\"");
  EXPECT_GT(finite["fem"]["smallest_det_f"], 0.5);
  // Linear theory takes half of a turn's cosine for growth across the axis.
  EXPECT_GT(linear["fem"]["volume_change_ml"],
            3 * std::abs(double(finite["fem"]["volume_change_ml"])));
  EXPECT_EQ(finite["settings"]["strain"], "finite");
}

TEST_F(UnitTetScene, MeshesOfOtherProgramsAreTakenOrNamedInTheirError) {
  const auto run_mesh = [&](const std::string& inp) {
    write_text(m_folder / "mesh.inp", inp);
    write_text(m_folder / "scene2.toml",
               "[volume]\npath = \"bar.nhdr\"\n[material]\ntable = \"tissue.toml\"\n[[step]]\n"
               "model = \"tets\"\n" +
                   m_held + "[step.tets]\nmesh = \"mesh.inp\"\n");
    return run_supple(
        {"run", m_folder / "scene2.toml", "-o", m_folder / "out", "--json", "--force"});
  };
  // A cube around the bar as five tetrahedra, a spare node, a material that no element has.
  const std::string nodes =
      "*NODE\n1, -1, -1, -1\n2, 12, -1, -1\n3, 12, 12, -1\n4, -1, 12, -1\n5, -1, -1, 24\n"
      "6, 12, -1, 24\n7, 12, 12, 24\n8, -1, 12, 24\n9, 50, 50, 50\n";
  const std::string tets =
      "*ELEMENT, TYPE=C3D4, ELSET=all\n1, 1, 2, 3, 6\n2, 1, 3, 4, 8\n3, 1, 6, 8, 5\n4, 3, 8, 6, "
      "7\n5, 1, 3, 8, 6\n";
  const Outcome taken = run_mesh(nodes + tets + "*MATERIAL, NAME=m\n*ELASTIC\n20, 0.3\n");
  ASSERT_EQ(taken.exit_code, 0) << taken.err;
  const json step = json::parse(taken.out)["steps"][0];
  EXPECT_EQ(step["tets"]["tetrahedra"], 5);
  EXPECT_EQ(step["tets"]["nodes"], 8);

  std::string metres = nodes;
  for (const char* number : {"12", "24"}) {
    for (std::size_t at; (at = metres.find(std::string(", ") + number)) != std::string::npos;) {
      metres.replace(at, 4, std::string(", 0.0") + number);
    }
  }
  const Outcome other = run_mesh(metres + tets);
  EXPECT_EQ(other.exit_code, 3) << other.err;
  EXPECT_NE(other.err.find("mesh.inp: mesh: found "), std::string::npos) << other.err;
  EXPECT_NE(other.err.find("a mesh of the body, which has 3.456 ml"), std::string::npos)
      << other.err;
}

TEST_F(UnitTetScene, WhatMeshesDoNotKnowIsRefusedInALine) {
  const std::string opening = "openings = [{ name = \"top\", toward = [0, 0, 1], degrees = 28 }]\n";
  const struct {
    std::string keys, tets, expected;
  } cases[] = {
      {m_held +
           "cut = [{ plane = { corner = [-1, -1, 8.5], edge1 = [20, 0, 0], edge2 = [0, 20, 0] } }]",
       "", "a body with cuts and labels = false beside tets"},
      {m_held +
           "cut = [{ plane = { corner = [-1, -1, 8.5], edge1 = [20, 0, 0], edge2 = [0, 20, 0] } "
           "}]",
       "labels = true", "a cut within label 1 beside tets"},
      {m_held + "cut = [{ label = 2, from = 2 }]", "", "from: found the label itself"},
      {m_held + "rigid_density = [60, 200]", "", "a body with rigid pieces beside tets"},
      {m_held, "sheets = [{ faces = \"lid\", stiffness = 1, thickness = 1 }]\n" + opening,
       "sheets: found lid, expected outside, top"},
      {m_held, "openings = [{ name = \"top\", toward = [0, 0, 0], degrees = 28 }]",
       "toward: found [0, 0, 0], expected a direction"},
      {m_held, "openings = [{ name = \"top\", toward = [0, 0, 1] }]", "degrees"},
      {m_held, opening.substr(0, opening.size() - 2) + ", " + opening.substr(12), "a second top"},
      {m_held, "openings = [{ name = \"top\", toward = [0, 0, 1], degrees = 0 }]",
       "top, without a face"},
      {m_held, "mesh = \"none.vtu\"\nspacing = 3", "spacing beside mesh"},
      {m_held, "shell_planes = true", "shell_planes: found no shell"},
      {m_held, "sheets = [{ between = [1, 2], stiffness = 1, thickness = 1 }]", "labels = true"},
      {m_held, "labels = true\nsheets = [{ between = [1, 7], stiffness = 1, thickness = 1 }]",
       "between: found labels 1 and 7, which share no face"},
      {m_held, "strain = \"finite\"\noutside = \"shell\"", "strain: found finite beside a shell"},
      {m_held, "strain = \"finite\"\nequations = \"factor\"", "strain: found finite beside factor"},
      {m_held, "openings = [{ name = \"1 to 2\", toward = [0, 0, 1], degrees = 28 }]",
       "openings: found 1 to 2"},
      {m_held + "limits = \"ball\"", "", "limits"},
      {m_held, "elemnts = 30", "elemnts"},
      {m_held + "handles = [{ grab = [6, 6, 20], by = [1, 0, 0], push = true }]", "", "push"},
  };
  for (const auto& [keys, tets, expected] : cases) {
    const std::string line = refusal(keys, tets);
    EXPECT_NE(line.find(expected), std::string::npos) << expected << "\n" << line;
    EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << line;
  }
}
