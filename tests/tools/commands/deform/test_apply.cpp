// supple apply: points, meshes and labels follow a state or a warp.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/io/mesh/triangle_mesh.h"

using namespace supple;
using namespace supple::test;

namespace {

/// A soft ball of 24^3 voxels of 1 x 1 x 1.5 mm, dragged by 3 mm along x at its right; labels 5
/// (x < 12) and 9 inside.
class DraggedBall : public ::testing::Test {
 protected:
  static constexpr int kSize = 24, kLayer = kSize * kSize;

  void SetUp() override {
    write_ball(m_folder, "ball", kSize);
    write_soft_material(m_folder / "soft.toml");
    const Outcome outcome =
        run({"deform", m_folder / "ball.nhdr", "--material", m_folder / "soft.toml", "--grab",
             "20,12,12", "--by", "3,0,0", "-o", m_folder / "drag.vdb"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    m_ball = read_text(m_folder / "ball.raw");
    std::string voxels;
    for (std::size_t n = 0; n < m_ball.size(); ++n) {
      voxels += char(std::uint8_t(m_ball[n]) < 50 ? 0 : n % kSize < 12 ? 5 : 9);
    }
    write_labels("labels", voxels);
  }

  void write_labels(const std::string& name, const std::string& voxels) {
    write_text(m_folder / (name + ".raw"), voxels);
    write_text(m_folder / (name + ".nhdr"),
               "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 24 24 24\nspace directions: (1,0,0) (0,1,0) (0,0,1.5)\n"
               "space origin: (0,0,0)\nencoding: raw\ndata file: " +
                   name + ".raw\n");
  }

  Outcome run(const std::vector<std::string>& arguments) { return run_supple(arguments); }
  Outcome apply(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "apply");
    return run(arguments);
  }
  std::string path(const std::string& name) const { return m_folder / name; }
  static std::string numbers(const std::string& csv) { return csv.substr(csv.find('\n') + 1); }

  TemporaryFolder m_folder;
  std::string m_ball;
};

using UnitApply = DraggedBall;
using PropertyApply = DraggedBall;
using FaultApply = DraggedBall;

}  // namespace

TEST_F(UnitApply, TheGrabbedPointGoesWhereItWasDraggedAndComesBack) {
  write_text(path("p.csv"), "name,x,y,z\ngrabbed,20,12,18\n");
  const Outcome outcome =
      apply({path("drag.vdb"), "--points", path("p.csv"), "-o", path("q.csv"), "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(read_text(path("q.csv")), "name,x,y,z\ngrabbed,23,12,18\n");
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["points"], 1);
  EXPECT_EQ(json["outside"], 0);
  EXPECT_EQ(json["unresolved"], 0);
  EXPECT_EQ(json["direction"], "forward");
  const Outcome back =
      apply({path("drag.vdb"), "--back", "--points", path("q.csv"), "-o", path("r.csv")});
  ASSERT_EQ(back.exit_code, 0) << back.err;
  double x = 0, y = 0, z = 0;
  ASSERT_EQ(
      std::sscanf(numbers(read_text(path("r.csv"))).c_str(), "grabbed,%lf,%lf,%lf", &x, &y, &z), 3);
  EXPECT_NEAR(x, 20, 1e-4);
  EXPECT_NEAR(y, 12, 1e-4);
  EXPECT_NEAR(z, 18, 1e-4);
}

TEST_F(UnitApply, PointsBeyondTheMaterialAreSaidWithTheLineOfTheFirst) {
  write_text(path("p.csv"), "x,y,z\n12,12,18\n100,100,100\n");
  const Outcome outcome =
      apply({path("drag.vdb"), "--points", path("p.csv"), "-o", path("q.csv"), "--json"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.err.find("1 point beyond the material"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("p.csv:3"), std::string::npos) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["outside"], 1);
}

TEST_F(PropertyApply, AStateAndItsExportedWarpsMovePointsAlike) {
  std::string csv = "x,y,z\n";
  for (int n = 0; n < 60; ++n) {
    csv += std::to_string(8 + n % 9) + ".3," + std::to_string(8 + n % 7) + ".1," +
           std::to_string(13 + n % 8) + ".7\n";
  }
  write_text(path("p.csv"), csv);
  ASSERT_EQ(apply({path("drag.vdb"), "--points", path("p.csv"), "-o", path("s.csv")}).exit_code, 0);
  for (const std::string direction : {"material", "resample"}) {
    ASSERT_EQ(
        run({"export", path("drag.vdb"), "--direction", direction, "-o", path("w.nrrd"), "--force"})
            .exit_code,
        0);
    const Outcome outcome =
        apply({path("w.nrrd"), "--points", path("p.csv"), "-o", path("w.csv"), "--force"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string a = numbers(read_text(path("s.csv"))), b = numbers(read_text(path("w.csv")));
    const char *p = a.c_str(), *q = b.c_str();
    // A resample warp is trilinear where the state is inverted exactly.
    const double limit = direction == "material" ? 1e-5 : 0.3;
    double worst = 0;
    for (int n = 0; n < 180; ++n) {
      char *p_end, *q_end;
      worst = std::max(worst, std::abs(std::strtod(p, &p_end) - std::strtod(q, &q_end)));
      p = p_end + 1;
      q = q_end + 1;
    }
    EXPECT_LT(worst, limit) << direction;
  }
}

TEST_F(UnitApply, AMeshMovesAndKeepsItsFaces) {
  RUN_WHEN_SANITIZED();
  write_text(path("m.ply"),
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
             "property float z\nproperty uchar red\nelement face 1\n"
             "property list uchar int vertex_indices\nend_header\n20 12 18 255\n0 0 0 1\n"
             "12 12 18 2\n3 0 1 2\n");
  const Outcome outcome =
      apply({path("drag.vdb"), "--mesh", path("m.ply"), "-o", path("n.ply"), "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string text = read_text(path("n.ply"));
  EXPECT_NE(text.find("end_header\n23 12 18 255\n"), std::string::npos) << text;
  EXPECT_EQ(text.substr(text.size() - 8), "3 0 1 2\n");
  EXPECT_EQ(read_mesh(path("n.ply")).triangles.size(), 1u);
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["points"], 3);
}

TEST_F(PropertyApply, LabelsAreThoseOfTheResampledVolumeAndNoneIsNew) {
  const Outcome outcome = apply(
      {path("drag.vdb"), "--labels", path("labels.nhdr"), "-o", path("moved.nhdr"), "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string moved = read_text(path("moved.raw"));
  ASSERT_EQ(moved.size(), m_ball.size()) << "the type is kept";
  EXPECT_EQ(std::set<char>(moved.begin(), moved.end()), (std::set<char>{0, 5, 9}));
  ASSERT_EQ(run({"resample", path("drag.vdb"), "-o", path("dense.nhdr")}).exit_code, 0);
  const std::string dense = read_text(path("dense.raw"));
  int moved_voxels = 0, empty = 0, interior = 0;
  for (int n = kLayer + kSize + 1; n < kSize * kLayer - kLayer - kSize - 1; ++n) {
    const bool is_labelled = moved[std::size_t(n)] != 0;
    moved_voxels += is_labelled != (std::uint8_t(m_ball[std::size_t(n)]) >= 50);
    if (dense[std::size_t(n)] == 0) {
      EXPECT_FALSE(is_labelled) << "a label would have left an eighth of 50";
      ++empty;
    }
    bool is_interior = true;
    for (int step = 0; step < 27; ++step) {
      const int by = (step / 9 - 1) * kLayer + (step / 3 % 3 - 1) * kSize + step % 3 - 1;
      is_interior = is_interior && std::uint8_t(dense[std::size_t(n + by)]) > 150;
    }
    if (!is_interior) continue;
    EXPECT_TRUE(is_labelled) << n;
    ++interior;
  }
  EXPECT_GT(moved_voxels, 20);
  EXPECT_GT(empty, 5000);
  EXPECT_GT(interior, 500);
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["labels"].size(), 2u);
  EXPECT_EQ(json["labels"][0]["label"], 5);
  EXPECT_EQ(json["labels"][1]["voxels_after"], std::count(moved.begin(), moved.end(), 9));
}

TEST_F(PropertyApply, LabelsThereAndBackAgreeInTheInterior) {
  ASSERT_EQ(apply({path("drag.vdb"), "--labels", path("labels.nhdr"), "-o", path("moved.nhdr")})
                .exit_code,
            0);
  const Outcome outcome =
      apply({path("drag.vdb"), "--back", "--labels", path("moved.nhdr"), "-o", path("again.nhdr")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string before = read_text(path("labels.raw")), after = read_text(path("again.raw"));
  ASSERT_EQ(after.size(), before.size());
  int interior = 0, wrong = 0;
  const int step[6] = {1, -1, kSize, -kSize, kSize * kSize, -kSize * kSize};
  for (int n = kSize * kSize; n < kSize * kSize * (kSize - 1); ++n) {
    bool is_interior = before[std::size_t(n)] != 0;
    for (const int by : step) {
      is_interior = is_interior && before[std::size_t(n + by)] == before[std::size_t(n)];
    }
    interior += is_interior;
    wrong += is_interior && after[std::size_t(n)] != before[std::size_t(n)];
  }
  EXPECT_GT(interior, 500);
  EXPECT_EQ(wrong, 0);
}

TEST_F(PropertyApply, LabelsThroughAnExportedWarpAreThoseOfTheState) {
  ASSERT_EQ(
      apply({path("drag.vdb"), "--labels", path("labels.nhdr"), "-o", path("a.nhdr")}).exit_code,
      0);
  ASSERT_EQ(run({"export", path("drag.vdb"), "--void", "outside", "-o", path("w.mha")}).exit_code,
            0);
  const Outcome outcome =
      apply({path("w.mha"), "--labels", path("labels.nhdr"), "-o", path("b.nhdr")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string a = read_text(path("a.raw")), b = read_text(path("b.raw"));
  int differ = 0;
  for (std::size_t n = 0; n < a.size(); ++n) differ += a[n] != b[n];
  EXPECT_LE(differ, 3) << "half way places may round apart";
}

TEST_F(UnitApply, LabelsMayLieOnAnotherGridAndLandOnAnyGrid) {
  // Half the voxels of the right half, on a grid of its own.
  write_text(path("coarse.raw"), std::string(3 * 6 * 6, 7));
  write_text(path("coarse.nhdr"),
             "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 3 6 6\n"
             "space directions: (-4,0,0) (0,4,0) (0,0,6)\nspace origin: (21.5,1.5,2.25)\n"
             "encoding: raw\ndata file: coarse.raw\n");
  const Outcome outcome =
      apply({path("drag.vdb"), "--labels", path("coarse.nhdr"), "--grid", path("coarse.nhdr"),
             "--margin", "4", "-o", path("out.nhdr"), "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["dims"], (std::vector<int>{5, 8, 8}));
  const std::string out = read_text(path("out.raw"));
  EXPECT_EQ(out[std::size_t((4 * 8 + 4) * 5 + 2)], 7);
  EXPECT_EQ(out[0], 0);
}

TEST_F(FaultApply, WrongCommandLinesAndFilesAreOneLine) {
  write_text(path("p.csv"), "x,y,z\n1,2,3\n");
  write_text(path("bad.csv"), "x,y\n1,2\n");
  write_text(path("inf.csv"), "x,y,z\n1,inf,3\n");
  write_text(path("cut.stl"), "solid\nfacet normal 0 0 1\nouter loop\nvertex 1 2");
  struct Case {
    std::vector<std::string> arguments;
    int exit_code;
    std::string says;
  };
  const std::string state = path("drag.vdb"), out = path("out.csv");
  const Case cases[] = {
      {{state, "-o", out}, 2, "found 0 of --points, --mesh and --labels"},
      {{state, "--points", path("p.csv"), "--mesh", path("cut.stl"), "-o", out}, 2, "found 2 of"},
      {{state, "--points", path("p.csv"), "--margin", "3", "-o", out}, 2, "without --labels"},
      {{state, "--points", path("p.csv"), "--frame", "1", "-o", out}, 2, "without --labels"},
      {{state, "--points", path("p.csv"), "-o", path("p.csv")}, 3, "the name of an input"},
      {{state, "--points", path("p.csv"), "-o", path("out.txt")}, 3, "extension .csv"},
      {{state, "--points", path("bad.csv"), "-o", out}, 3, "columns x,y,z"},
      {{state, "--points", path("inf.csv"), "-o", out}, 3, "a finite number"},
      {{state, "--points", path("none.csv"), "-o", out}, 3, "none.csv"},
      {{state, "--mesh", path("cut.stl"), "-o", path("out.stl")}, 3, "line 4"},
      {{state, "--mesh", path("cut.stl"), "-o", path("out.ply")}, 3, "extension .stl"},
      {{state, "--labels", path("labels.nhdr"), "-o", path("out.png")}, 3, "out.png"},
      {{path("ball.nhdr"), "--points", path("p.csv"), "-o", out}, 3, "a warp"},
      {{state, "--points", path("p.csv"), "-o", out, "--unknown"}, 2, "--unknown"}};
  for (const Case& wrong : cases) {
    const Outcome outcome = apply(wrong.arguments);
    EXPECT_EQ(outcome.exit_code, wrong.exit_code) << outcome.err;
    EXPECT_NE(outcome.err.find(wrong.says), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(out));
  }
  write_text(out, "old");
  EXPECT_EQ(apply({state, "--points", path("p.csv"), "-o", out}).exit_code, 2);
  EXPECT_EQ(read_text(out), "old");
}
