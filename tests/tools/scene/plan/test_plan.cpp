// Plans: what `--dry-run` says of a scene, and that a run holds and computes no more than that.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "raycast/pictures/image.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "tools/scene/run/view_pictures.h"

using namespace supple::test;

namespace {

using Json = nlohmann::json;

const std::string kPlannedStep = "[[step]]\ngrab = [12, 12, 12]\nby = [0.0, 3.0, 0.0]\n";
const std::string kPlannedView = "[[view]]\nimage = \"a.png\"\nsize = [64, 48]\n";

class UnitPlan : public ::testing::Test {
 protected:
  UnitPlan() {
    write_ball(m_folder, "ball", 24);
    write_soft_material(m_folder / "soft.toml");
  }

  /// Runs a command on a scene; returns what it prints with --json.
  Json run(const std::string& text, const std::vector<std::string>& more = {}) {
    write_text(m_folder / "scene.toml",
               "[volume]\npath = \"ball.nhdr\"\n[material]\ntable = \"soft.toml\"\n" + text);
    std::vector<std::string> words = {
        "run", m_folder / "scene.toml", "-o", m_folder / "out", "--force", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return json_of(words);
  }
  static Json json_of(const std::vector<std::string>& words) {
    const Outcome outcome = run_supple(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.exit_code == 0 ? Json::parse(outcome.out) : Json();
  }
  Json plan(const std::string& text) { return run(text, {"--dry-run"}).at("plan"); }

  TemporaryFolder m_folder;
};

/// True if some row, or something that is left out, begins with these words.
bool says(const Json& list, const std::string& words) {
  for (const Json& entry : list) {
    if (entry.at("what").get<std::string>().rfind(words, 0) == 0) return true;
  }
  return false;
}

bool has_stage(const Json& report, const std::string& name) {
  return report.at("stage_seconds").contains(name);
}

TEST_F(UnitPlan, ADragAlongOneAxisNeedsOneCoordinate) {
  const Json plan = this->plan(kPlannedStep + kPlannedView);
  EXPECT_TRUE(says(plan.at("rows"), "coordinate j"));
  for (const char* other : {"i", "k"}) {
    EXPECT_FALSE(says(plan.at("rows"), std::string("coordinate ") + other));
    EXPECT_TRUE(says(plan.at("not"), std::string("step 1: coordinate ") + other));
  }
}

TEST_F(UnitPlan, RelaxationIsPlannedWhereAStepAsksForIt) {
  const Json without = plan(kPlannedStep + kPlannedView),
             with = plan(kPlannedStep + "relax = { passes = 5 }\n" + kPlannedView);
  EXPECT_TRUE(says(without.at("not"), "step 1: stiffness"));
  EXPECT_FALSE(says(with.at("not"), "step 1: stiffness"));
  EXPECT_TRUE(says(with.at("rows"), "stiffness and up to 5 passes"));
  double seconds = 0;
  for (const Json& row : with.at("rows")) {
    const bool is_relaxation = says(Json::array({row}), "stiffness and up to 5 passes");
    if (is_relaxation) seconds = row.at("seconds");
  }
  EXPECT_GT(seconds, 0);
}

TEST_F(UnitPlan, FiniteElementsTakeAsLongAsToleranceAndFixedBoxesAsk) {
  const auto row = [&](const std::string& keys) {
    const Json rows =
        plan("[[step]]\ngrab = [12, 12, 12]\nby = [0.0, 1.0, 0.0]\n" + keys).at("rows");
    for (const Json& found : rows) {
      if (found.at("what").get<std::string>().find("unknowns") != std::string::npos) return found;
    }
    return Json();
  };
  const std::string loose = "model = \"fem\"\nfem = { tolerance = 0.1 }\n";
  const Json quick = row(loose), exact = row("model = \"fem\"\nfem = { tolerance = 1e-8 }\n"),
             held = row(loose + "fix = [[0, 0, 0, 24, 9, 24]]\n");
  EXPECT_LT(quick.at("seconds"), exact.at("seconds"));
  EXPECT_LT(held.at("seconds"), quick.at("seconds"));
  EXPECT_EQ(quick.at("brief_mb"), exact.at("brief_mb"));
}

TEST_F(UnitPlan, UnknownsOfFiniteElementsAreThoseThatAnchorsLeaveFree) {
  const Json json =
      run("[[step]]\ngrab = [12, 12, 12]\nby = [0.0, 1.0, 0.0]\nmodel = \"fem\"\n"
          "fix = [[0, 0, 0, 24, 9, 24]]\n",
          {"--plan"});
  double planned = 0;
  for (const Json& row : json.at("plan").at("rows")) {
    const std::string what = row.at("what");
    if (what.find("unknowns") != std::string::npos) planned = std::stod(what);
  }
  const double were = json.at("steps")[0].at("fem").at("unknowns");
  EXPECT_NEAR(planned / were, 1, 0.03);
}

TEST_F(UnitPlan, WithoutExportAndDeformedViewsNothingIsInverted) {
  const std::string at_rest = kPlannedView + "deformed = false\n",
                    solving = kPlannedView + "inverse = false\n";
  for (const std::string& view : {at_rest, solving}) {
    EXPECT_TRUE(says(plan(kPlannedStep + view).at("not"), "inverse (offsets)")) << view;
    EXPECT_FALSE(has_stage(run(kPlannedStep + view), "inverting")) << view;
  }
  for (const std::string& more : {kPlannedView, std::string("[output]\nstate = \"a.vdb\"\n")}) {
    EXPECT_FALSE(says(plan(kPlannedStep + more).at("not"), "inverse (offsets)")) << more;
    EXPECT_TRUE(has_stage(run(kPlannedStep + more), "inverting")) << more;
  }
}

TEST_F(UnitPlan, AnExportOfDisplacementsAloneNeedsNoInverse) {
  const std::string output = "[output]\ndisplacements = [\"u.nrrd\"]\n";
  EXPECT_TRUE(says(plan(kPlannedStep + output).at("not"), "inverse (offsets)"));
  EXPECT_FALSE(has_stage(run(kPlannedStep + output), "inverting"));
}

/// A ball that is dragged, and a camera that sees a small part of it.
class UnitSeenBricks : public UnitPlan {
 protected:
  UnitSeenBricks() { write_ball(m_folder, "ball", 96); }

  static double cells(const Json& report) { return report.at("certificate").at("cells"); }

  const std::string m_step =
      "[[step]]\ngrab_ball = [48, 30, 48]\nradius = 20\nby = [2.0, 3.0, 0.0]\n";
  const std::string m_close =
      "[[view]]\nimage = \"a.png\"\nsize = [120, 90]\npreset = \"MR-Default\"\n"
      "camera = { position = [-47.0, -190.0, 101.0], target = [25.0, 48.0, 60.0], up = [0.0, 0.0, "
      "1.0], fov = 4.0 }\n";
  const std::string m_export = "[output]\nstate = \"s.vdb\"\n";
};

TEST_F(UnitSeenBricks, OthersAreNotInvertedAndThePictureStaysTheSame) {
  const Json some = run(m_step + m_close, {"--plan"});
  const supple::Image picture = supple::read_png(m_folder / "out/a.png");
  const Json all = run(m_step + m_close + m_export, {"--plan"});
  EXPECT_EQ(picture.rgba, supple::read_png(m_folder / "out/a.png").rgba);
  EXPECT_TRUE(says(some.at("plan").at("not"), "offsets of "));
  EXPECT_FALSE(says(all.at("plan").at("not"), "offsets of "));
  EXPECT_LT(cells(some), 0.95 * cells(all));
  EXPECT_TRUE(some.at("certificate").contains("of_part"));
  EXPECT_FALSE(all.at("certificate").contains("of_part"));
  EXPECT_EQ(some.at("certificate").at("hidden_elements"), 0);
}

TEST_F(UnitSeenBricks, OfSlicesAndPairsOfEyesTooThePictureStaysTheSame) {
  const std::string slice = "[[view]]\nimage = \"a.png\"\nslice = { at = [50, 28, 46], ";
  const std::string marks = "overlay = \"displacement\", overlay_range = [0, 4]";
  for (const std::string& view :
       {slice + "plane = \"axial\", " + marks + " }\n",
        slice + "plane = \"axial\", arrows = 7, overlay = \"det_f\" }\n",
        slice + "normal = [0.3, 0.2, 1.0], thickness = 12, grid = 8 }\n",
        slice + "plane = \"coronal\", lightbox = [2, 1], every = 6 }\n",
        m_close + "stereo = \"side-by-side\"\neye_separation = 150.0\n"}) {
    const double some = cells(run(m_step + view));
    const supple::Image picture = supple::read_png(m_folder / "out/a.png");
    const double all = cells(run(m_step + view + m_export));
    EXPECT_EQ(picture.rgba, supple::read_png(m_folder / "out/a.png").rgba) << view;
    EXPECT_LT(some, 0.95 * all) << view;
  }
}

// The eyes see different places before the plane in which the cameras' windows meet.
TEST_F(UnitSeenBricks, EachEyeSeesPlacesThatTheOtherDoesNot) {
  const supple::Geometry geometry({64, 64, 64}, supple::Vec3d(0),
                                  {supple::Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  supple::tools::SceneView view;
  supple::Camera camera;
  camera.position_lps_mm = {32, -468, 32};
  camera.target_lps_mm = {32, 132, 32};
  camera.vertical_fov_degrees = 4;
  view.camera.camera = camera;
  view.size = {64, 64};
  view.picture.stereo = supple::tools::StereoMode::side_by_side;
  view.picture.eye_separation_mm = 150;
  const auto seen = supple::tools::seen_of(view, geometry);
  ASSERT_TRUE(seen.has_value());
  ASSERT_EQ(seen->size(), 2U);
  // The middles of the windows at j = 32, five sixths of the way, are 12.5 mm to either side.
  const auto is_seen = [&](int eye, double i) {
    return (*seen)[eye].meets({i, 31, 31}, {i + 1, 32, 32});
  };
  EXPECT_TRUE(is_seen(0, 4));
  EXPECT_FALSE(is_seen(1, 4));
  EXPECT_TRUE(is_seen(1, 59));
  EXPECT_FALSE(is_seen(0, 59));
}

TEST_F(UnitSeenBricks, ViewsThatReadOffsetsBesideTheirPictureInvertAll) {
  const double all = cells(run(m_step + m_close + m_export));
  const std::string other = "[[view]]\nimage = \"b.png\"\nsize = [64, 48]\n";
  for (const std::string& more :
       {std::string("shadows = true\n"), std::string("overlay = \"displacement\"\n"), other,
        std::string("[[view]]\nimage = \"s.png\"\nslice = { overlay = \"displacement\" }\n")}) {
    EXPECT_EQ(cells(run(m_step + m_close + more)), all) << more;
  }
  const std::string with_range = "overlay = \"displacement\"\noverlay_range = [0, 4]\n";
  EXPECT_LT(cells(run(m_step + m_close + with_range)), all);
}

TEST_F(UnitSeenBricks, APlanCountsTheStepOfWhichViewsSeeMost) {
  const Json early = plan(m_step + m_step + m_close + "after_step = 1\n"),
             late = plan(m_step + m_step + m_close);
  const auto offsets_of = [](const Json& plan) {
    for (const Json& row : plan.at("rows")) {
      const auto what = row.at("what").get<std::string>();
      if (what.rfind("offsets of ", 0) == 0) return what;
    }
    return std::string();
  };
  EXPECT_EQ(offsets_of(early), offsets_of(late));
  EXPECT_EQ(offsets_of(early).find("offsets of 0 "), std::string::npos);
}

TEST_F(UnitPlan, WithoutPicturesNothingIsRendered) {
  const std::string output = "[output]\noffsets = [\"w.nrrd\"]\n";
  EXPECT_TRUE(says(plan(kPlannedStep + output).at("not"), "sampling bricks, Embree's scene"));
  EXPECT_FALSE(has_stage(run(kPlannedStep + output), "rendering"));
  EXPECT_FALSE(
      says(plan(kPlannedStep + kPlannedView).at("not"), "sampling bricks, Embree's scene"));
  EXPECT_TRUE(has_stage(run(kPlannedStep + kPlannedView), "rendering"));
}

TEST_F(UnitPlan, ARunThatWasPlannedSaysWhatCameOfIt) {
  const Json report = run(kPlannedStep + kPlannedView, {"--plan"});
  const Json& outcome = report.at("outcome");
  EXPECT_EQ(outcome.at("peak_mb"), report.at("plan").at("peak_mb"));
  EXPECT_GT(outcome.at("was_seconds"), 0);
  if (kSanitized) return;  // shadow memory is in no plan
  // The volume is small, so that most of it is the program, of which a fork holds less.
  const double ratio =
      outcome.at("peak_mb").get<double>() / outcome.at("was_peak_mb").get<double>();
  EXPECT_GT(ratio, 0.8);
  EXPECT_LT(ratio, 1.5);
}

TEST_F(UnitPlan, SpringsOfASolidHoldWhatWasPlanned) {
  write_ball(m_folder, "ball", 64);
  const std::string step = "[[step]]\ngrab = [32, 32, 32]\nby = [0.0, 3.0, 0.0]\n",
                    springs = "model = \"springs\"\nsprings = { minimise = true, steps = 1 }\n";
  const Json report = run(step + springs + kPlannedView, {"--plan"});
  for (const char* axis : {"i", "j", "k"}) {
    EXPECT_TRUE(says(report.at("plan").at("rows"), std::string("coordinate ") + axis));
  }
  if (kSanitized) return;  // shadow memory is in no plan
  // The program itself, which differs from machine to machine, is in both runs.
  const Json others = run(step + kPlannedView, {"--plan"});
  const auto more = [&](const char* peak) {
    return report.at("outcome").at(peak).get<double>() -
           others.at("outcome").at(peak).get<double>();
  };
  const double ratio = more("peak_mb") / more("was_peak_mb");
  EXPECT_GT(ratio, 0.7);
  EXPECT_LT(ratio, 1.2);
}

TEST_F(UnitPlan, OptionsOfCommandsArePlannedAsScenesOfOneStep) {
  const Json deform = json_of({"deform", m_folder / "ball.nhdr", "--grab", "12,12,12", "--by",
                               "0,3,0", "-o", m_folder / "s.vdb", "--dry-run", "--json"});
  EXPECT_TRUE(says(deform.at("plan").at("rows"), "coordinate j"));
  EXPECT_FALSE(std::filesystem::exists(m_folder / "s.vdb"));
  const Json render =
      json_of({"render", m_folder / "ball.nhdr", "-o", m_folder / "p.png", "--dry-run", "--json"});
  EXPECT_TRUE(says(render.at("plan").at("not"), "a body"));
  EXPECT_FALSE(std::filesystem::exists(m_folder / "p.png"));
}

TEST_F(UnitPlan, TheTableNamesStagesReasonsAndWhatIsLeftOut) {
  write_text(m_folder / "scene.toml",
             "[volume]\npath = \"ball.nhdr\"\n" + kPlannedStep + kPlannedView);
  const Outcome outcome = run_supple({"run", m_folder / "scene.toml", "--dry-run"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* words : {"stage", "why", "memory", "a handle moves along it", "view a.png",
                            "not     step 1: coordinate i: no handle moves along it", "peak "}) {
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words << " in " << outcome.out;
  }
}

}  // namespace
