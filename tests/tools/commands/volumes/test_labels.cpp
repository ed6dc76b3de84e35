// Label volumes on the command line and in scenes.
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lib/state/state.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/grid/labels.h"

using namespace supple;
using namespace supple::test;

namespace {

/// A ball whose lower half along i has label 1 and the upper one label 2; label 3 is a core of
/// both.
class LabelledBall : public ::testing::Test {
 protected:
  static constexpr int kSize = 24;

  void SetUp() override {
    write_ball(m_folder, "ball", kSize);
    write_soft_material(m_folder / "soft.toml");
    write_text(m_folder / "rigid_core.toml",
               read_text(m_folder / "soft.toml") +
                   "[label.core]\nmax_length = [[0, 1.0]]\nmin_length = [[0, 1.0]]\n"
                   "shear = [[0, 0.0]]\n");
    std::string voxels;
    for (int k = 0; k < kSize; ++k) {
      for (int j = 0; j < kSize; ++j) {
        for (int i = 0; i < kSize; ++i) voxels += char(label_at({i, j, k}));
      }
    }
    write_text(m_folder / "labels.raw", voxels);
    write_header("labels", "24 24 24");
  }

  static int label_at(const Vec3i& voxel) {
    const Vec3i d = voxel - Vec3i(12);
    if (d.x * d.x + d.y * d.y + d.z * d.z <= 9) return 3;
    return voxel.x < 12 ? 1 : 2;
  }

  void write_header(const std::string& name, const std::string& sizes) {
    write_text(
        m_folder / (name + ".nhdr"),
        "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: " + sizes +
            "\nspace directions: (1,0,0) (0,1,0) (0,0,1.5)\nspace origin: (0,0,0)\n"
            "encoding: raw\ndata file: labels.raw\nSegment0_Name:=right half\n"
            "Segment0_LabelValue:=1\nSegment1_Name:=left half\nSegment1_LabelValue:=2\n"
            "Segment2_Name:=core\nSegment2_LabelValue:=3\n");
  }

  Outcome deform(const std::string& input, std::vector<std::string> more,
                 const std::string& material = "soft.toml") {
    std::vector<std::string> arguments = {"deform", m_folder / input,    "--json", "--force",
                                          "-o",     m_folder / "out.vdb"};
    if (input == "ball.nhdr") {
      more.insert(more.end(),
                  {"--material", m_folder / material, "--labels", m_folder / "labels.nhdr"});
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_supple(arguments);
  }

  State state() { return read_state(m_folder / "out.vdb"); }

  /// Offsets of a label's elements along i in voxels: smallest and largest.
  std::pair<double, double> moves_of(int label) {
    const State state = this->state();
    const BrickTopology mask = label_mask(state.elements, state.labels, label);
    double least = 1e9, greatest = -1e9;
    for (std::size_t b = 0; b < mask.brick_count(); ++b) {
      const auto brick = std::size_t(state.elements.find(mask.origin(b)));
      for_each_active(mask.mask(b), [&](int offset) {
        const double move = state.q[0].at(brick * kBrickVoxels + std::size_t(offset)) / kFixedOne;
        least = std::min(least, move);
        greatest = std::max(greatest, move);
      });
    }
    return {least, greatest};
  }

  Outcome run_scene(const std::string& steps, const std::string& material = "rigid_core.toml") {
    write_text(m_folder / "scene.toml",
               "[volume]\npath = \"ball.nhdr\"\n[labels]\npath = \"labels.nhdr\"\n"
               "[material]\ntable = \"" +
                   material + "\"\n" + steps + "[output]\nstate = \"out.vdb\"\n");
    return run_supple({"run", m_folder / "scene.toml", "-o", m_folder.path(), "--json", "--force"});
  }

  TemporaryFolder m_folder;
};

using UnitLabels = LabelledBall;
using FaultLabels = LabelledBall;

}  // namespace

TEST_F(UnitLabels, AGrabbedLabelMovesAsOne) {
  const Outcome outcome = deform("ball.nhdr", {"--grab", "label:3", "--by", "2,0,0"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(moves_of(3), std::make_pair(2.0, 2.0));
  EXPECT_LT(moves_of(1).first, 2.0);
}

TEST_F(UnitLabels, ARigidLabelKeepsItsShapeWhenItsSurroundingsAreDragged) {
  RUN_WHEN_SANITIZED();
  const Outcome soft = deform("ball.nhdr", {"--grab", "20,12,12", "--by", "8,0,0"});
  ASSERT_EQ(soft.exit_code, 0) << soft.err;
  EXPECT_LT(moves_of(3).first, moves_of(3).second);
  const Outcome rigid =
      deform("ball.nhdr", {"--grab", "20,12,12", "--by", "8,0,0"}, "rigid_core.toml");
  ASSERT_EQ(rigid.exit_code, 0) << rigid.err;
  EXPECT_EQ(moves_of(3).first, moves_of(3).second);
  EXPECT_GT(moves_of(3).first, 0.0);
}

TEST_F(UnitLabels, AFixedLabelStaysAndIsStillFixedInTheContinuedState) {
  ASSERT_EQ(
      deform("ball.nhdr", {"--fix", "label:1", "--grab", "20,12,12", "--by", "1,0,0"}).exit_code,
      0);
  EXPECT_EQ(moves_of(1), std::make_pair(0.0, 0.0));
  EXPECT_EQ(state().anchor_labels, std::vector<std::int32_t>{1});
  const Outcome more = deform("out.vdb", {"--grab", "20,12,12", "--by", "90,0,0"});
  ASSERT_EQ(more.exit_code, 0) << more.err;
  EXPECT_NE(more.err.find("anchors stopped the drag"), std::string::npos) << more.err;
  EXPECT_EQ(moves_of(1), std::make_pair(0.0, 0.0));
  const Outcome other = deform(
      "out.vdb", {"--grab", "20,12,12", "--by", "1,0,0", "--labels", m_folder / "labels.nhdr"});
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_NE(other.err.find("a state without fixed labels"), std::string::npos) << other.err;
}

TEST_F(UnitLabels, ACutLabelPushesItsSurroundingsAndPullsNothingAlong) {
  const std::vector<std::string> options = {"--cut",   "label:3", "--grab",
                                            "label:3", "--by",    "3,0,0"};
  const Outcome outcome = deform("ball.nhdr", options);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_GT(nlohmann::json::parse(outcome.out)["cut_links"], 0);
  EXPECT_EQ(moves_of(3), std::make_pair(3.0, 3.0));
  EXPECT_EQ(moves_of(1).first, 0.0);
  EXPECT_GT(moves_of(2).second, 2.0);

  write_text(m_folder / "passing.toml", "contact = false\n" + read_text(m_folder / "soft.toml"));
  ASSERT_EQ(deform("ball.nhdr", options, "passing.toml").exit_code, 0);
  EXPECT_EQ(moves_of(3), std::make_pair(3.0, 3.0));
  EXPECT_EQ(moves_of(1), std::make_pair(0.0, 0.0));
  EXPECT_EQ(moves_of(2), std::make_pair(0.0, 0.0));
}

TEST_F(UnitLabels, ScenesAskForLabelsAsTheCommandLineDoes) {
  const Outcome scene = run_scene(
      "[[step]]\ngrab_label = \"core\"\nby = [1.0, 0.0, 0.0]\nfix_label = [\"left half\"]\n"
      "cut = [{ label = \"2\" }]\n");
  ASSERT_EQ(scene.exit_code, 0) << scene.err;
  const State from_scene = state();
  ASSERT_EQ(deform("ball.nhdr",
                   {"--grab", "label:3", "--by", "1,0,0", "--fix", "label:2", "--cut", "label:2"},
                   "rigid_core.toml")
                .exit_code,
            0);
  const State from_deform = state();
  EXPECT_TRUE(from_scene.q == from_deform.q);
  EXPECT_TRUE(from_scene.cuts == from_deform.cuts);
  EXPECT_EQ(from_scene.configuration, from_deform.configuration);
  EXPECT_EQ(from_scene.material_toml, from_deform.material_toml);
  EXPECT_EQ(from_scene.anchor_labels, std::vector<std::int32_t>{2});
}

TEST_F(UnitLabels, AReleaseLetsGoOfFixedLabels) {
  const std::string step = "[[step]]\ngrab = [20, 12, 12]\nby = [1.0, 0.0, 0.0]\n";
  ASSERT_EQ(run_scene(step + "fix_label = [1, 3]\n" + step + "release = true\n").exit_code, 0);
  EXPECT_TRUE(state().anchor_labels.empty());
}

TEST_F(UnitLabels, InfoListsTheLabelsAndTheirElements) {
  ASSERT_EQ(deform("ball.nhdr", {"--fix", "label:3"}).exit_code, 0);
  const auto json = nlohmann::json::parse(run_supple({"info", "--json", m_folder / "out.vdb"}).out);
  EXPECT_EQ(json["labels"].size(), 3u);
  std::int64_t core = 0, elements = 0;
  for (int n = 0; n < kSize * kSize * kSize; ++n) {
    core += label_at({n % kSize, n / kSize % kSize, n / kSize / kSize}) == 3;
  }
  for (const auto& entry : json["labels"]) elements += entry.get<std::int64_t>();
  EXPECT_EQ(json["labels"]["3"], core);
  EXPECT_EQ(json["active_voxels"], elements);
}

TEST_F(UnitLabels, AContinuedStateKeepsTheTablesOfItsLabels) {
  ASSERT_EQ(deform("ball.nhdr", {"--fix", "2,12,12:5,12,12"}, "rigid_core.toml").exit_code, 0);
  const std::string material = state().material_toml;
  EXPECT_NE(material.find("[label.3]"), std::string::npos) << material;
  ASSERT_EQ(deform("out.vdb", {"--grab", "20,12,12", "--by", "8,0,0"}).exit_code, 0);
  EXPECT_EQ(moves_of(3).first, moves_of(3).second);
  EXPECT_GT(moves_of(3).first, 0.0);
  EXPECT_EQ(state().material_toml, material);
}

TEST_F(FaultLabels, ATableWithoutElementsIsAWarning) {
  write_text(m_folder / "soft.toml", read_text(m_folder / "rigid_core.toml") +
                                         "[label.9]\nmax_length = [[0, 1.1]]\n"
                                         "min_length = [[0, 0.9]]\nshear = [[0, 0.1]]\n");
  const Outcome outcome = deform("ball.nhdr", {"--grab", "label:3", "--by", "1,0,0"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.err.find("label.9: no element has this label"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(outcome.err.find("label.3"), std::string::npos) << outcome.err;
}

TEST_F(FaultLabels, LabelsThatAreNotThereAreNamed) {
  const auto expect = [](const Outcome& outcome, int code, const std::string& part) {
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  };
  const std::string found = "found labels from 1 to 3 without it";
  expect(deform("ball.nhdr", {"--grab", "label:4", "--by", "1,0,0"}), 3, "grab label:4: " + found);
  expect(deform("ball.nhdr", {"--fix", "label:65535"}), 3, "fix label:65535: " + found);
  expect(deform("ball.nhdr", {"--cut", "label:4"}), 3, "cut label:4: " + found);
  expect(deform("ball.nhdr", {"--fix", "label:0"}), 2, "label:N with N from 1 to 65535");
  expect(deform("ball.nhdr", {"--cut", "label:"}), 2, "label:N");
  expect(deform("ball.nhdr", {"--grab", "label:3", "--by", "1,0,0", "--fix", "label:3"}), 3,
         "label:3");
  expect(run_scene("[[step]]\ngrab_label = 0\nby = [1.0, 0.0, 0.0]\n"), 3, "scene.toml:8");
  expect(run_scene("[[step]]\nfix_label = [1.5]\n"), 3, "found 1.5, expected a label, 1 to 65535");
  expect(run_scene("[[step]]\ncut = [{ label = 4 }]\n"), 3, found);
  expect(run_scene("[[step]]\ngrab_label = 1\ngrab = [8, 8, 8]\nby = [1.0, 0.0, 0.0]\n"), 3,
         "grab_label");
  write_text(m_folder / "soft.toml", read_text(m_folder / "soft.toml") + "[label.\"left\"]\n");
  expect(deform("ball.nhdr", {"--fix", "label:1"}), 3,
         "found \"left\", expected a label, 1 to 65535, or the name of one segment: right half, "
         "left half, core");
}

TEST_F(FaultLabels, LabelVolumesMustHoldLabelsOnTheVolumesGrid) {
  RUN_WHEN_SANITIZED();
  write_header("labels", "24 48 12");
  Outcome outcome = deform("ball.nhdr", {"--fix", "label:1"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.err.find("labels.nhdr: dims: found 24,48,12, expected 24,24,24"),
            std::string::npos)
      << outcome.err;
  write_text(m_folder / "labels.nhdr",
             "NRRD0004\ntype: int8\ndimension: 3\nspace: left-posterior-superior\n"
             "sizes: 24 24 24\nspace directions: (1,0,0) (0,1,0) (0,0,1.5)\n"
             "space origin: (0,0,0)\nencoding: raw\ndata file: labels.raw\n");
  std::string voxels = read_text(m_folder / "labels.raw");
  voxels[24 * 24 + 24 + 5] = char(-3);
  write_text(m_folder / "labels.raw", voxels);
  outcome = deform("ball.nhdr", {"--fix", "label:1"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.err.find("label at 5,1,1: found -3"), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(m_folder / "out.vdb"));
}

TEST(InteropRealLabels, ARigidThalamusOfTheAalAtlasMovesAsOneInsideTheBrain) {
  const std::string aal = public_volume("aal.nii.gz"), ch2 = public_volume("ch2.nii.gz");
  if (aal.empty() || ch2.empty()) GTEST_SKIP() << "mricron-data is not installed";
  const TemporaryFolder folder;
  write_text(folder / "brain.toml",
             "domain = [0, 255]\nactive = [40, 255]\nmax_length = [[0, 1.2]]\n"
             "min_length = [[0, 0.8]]\nshear = [[0, 0.2]]\n"
             "[label.77]\nmax_length = [[0, 1.0]]\nmin_length = [[0, 1.0]]\nshear = [[0, 0.0]]\n");
  const Outcome outcome =
      run_supple({"deform", ch2, "--material", folder / "brain.toml", "--labels", aal, "--grab",
                  "label:37", "--by", "0,6,0", "--quiet", "-o", folder / "out.vdb"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const State state = read_state(folder / "out.vdb");
  const auto offsets_of = [&](int label) {
    const BrickTopology mask = label_mask(state.elements, state.labels, label);
    std::map<std::int32_t, int> offsets;
    for (std::size_t b = 0; b < mask.brick_count(); ++b) {
      const auto brick = std::size_t(state.elements.find(mask.origin(b)));
      for_each_active(mask.mask(b), [&](int offset) {
        ++offsets[state.q[1].at(brick * kBrickVoxels + std::size_t(offset))];
      });
    }
    return offsets;
  };
  EXPECT_EQ(offsets_of(37).size(), 1u);  // the hippocampus that was dragged
  EXPECT_EQ(offsets_of(77).size(), 1u);
  EXPECT_GT(offsets_of(78).size(), 1u);  // its counterpart is as soft as the rest
}
