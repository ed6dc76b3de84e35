// Pictures of a state in which each sample solves for itself (`--no-inverse`, `inverse = false`).
#include <algorithm>

#include <gtest/gtest.h>

#include "raycast/pictures/compare.h"
#include "raycast/pictures/image.h"
#include "tests/tools/golden.h"

using namespace supple;
using namespace supple::test;

namespace {

/// The sheared head, all of which has moved, from its left.
class WithoutInverse : public testing::Test {
 protected:
  WithoutInverse() { m_folder.run("shear"); }

  Outcome render(const std::string& image, std::vector<std::string> more,
                 const std::string& state = "shear.vdb") const {
    const std::vector<std::string> head = {
        "render", m_folder / state, "--view",  "left", "--preset",      "Skin",
        "--size", "160,160",        "--force", "-o",   m_folder / image};
    more.insert(more.begin(), head.begin(), head.end());
    return run_supple(more);
  }
  Outcome view(const std::string& keys) const {
    write_text(m_folder / "view.toml", "[volume]\npath = \"shear.vdb\"\n" + keys);
    return run_supple({"run", m_folder / "view.toml", "-o", m_folder / "", "--force"});
  }
  Image file(const std::string& name) const { return read_png(m_folder / name); }
  void render_both(const std::string& image, std::vector<std::string> more,
                   const std::string& state = "shear.vdb") const {
    EXPECT_EQ(render("inverse_" + image, more, state).exit_code, 0);
    more.emplace_back("--no-inverse");
    const Outcome outcome = render(image, more, state);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  double ssim_of(const std::string& image) const {
    return compare(file("inverse_" + image), file(image), true).ssim;
  }
  void expect_refused(const Outcome& outcome, int exit_code, const std::string& line) const {
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    EXPECT_NE(outcome.err.find(line), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }

  const GoldenFolder m_folder;
};

using PropertyWithoutInverse = WithoutInverse;
using UnitWithoutInverse = WithoutInverse;
using FaultWithoutInverse = WithoutInverse;

TEST_F(PropertyWithoutInverse, ThePictureIsThatOfTheInverse) {
  render_both("a.png", {});
  EXPECT_GE(ssim_of("a.png"), 0.995);
  EXPECT_NE(file("a.png").rgba, file("inverse_a.png").rgba);  // it came by another way
  ASSERT_EQ(render("rest.png", {"--undeformed"}).exit_code, 0);
  EXPECT_LT(compare(file("a.png"), file("rest.png"), true).ssim, 0.95);
}

TEST_F(PropertyWithoutInverse, LightsAndClipsOfTheTissueAreThoseOfTheInverse) {
  render_both("a.png", {"--shadows", "--clip-plane", "0,0,0:1,0,0", "--clip-space", "source"});
  EXPECT_GE(ssim_of("a.png"), 0.995);
}

TEST_F(PropertyWithoutInverse, OffsetLengthsAndTheirColoursAreThoseOfTheInverse) {
  render_both("a.png", {"--aux", "offset"});
  EXPECT_GE(ssim_of("a_offset.png"), 0.995);
}

TEST_F(PropertyWithoutInverse, EveryPictureOfASeriesIsThatOfTheInverse) {
  // There are no folds, and steps so fine that it does not matter where on a ray they begin.
  m_folder.run("head");
  for (const char* series : {"--sequence", "--turntable"}) {
    render_both("s_%d.png", {series, "3", "--step", "0.1"}, "head.vdb");
    for (const char* name : {"s_0.png", "s_1.png", "s_2.png"}) {
      EXPECT_GE(ssim_of(name), 0.995) << series << name;
    }
    EXPECT_LT(compare(file("s_0.png"), file("s_2.png"), true).ssim, 0.99) << series;
  }
}

TEST_F(UnitWithoutInverse, AViewOfASceneIsThePictureOfTheCommandLineAndSaysSo) {
  const Outcome scene = view(
      "[[view]]\nimage = \"view.png\"\npreset = \"Skin\"\nsize = [160, 160]\n"
      "camera = { view = \"left\" }\ninverse = false\n");
  ASSERT_EQ(scene.exit_code, 0) << scene.err;
  ASSERT_EQ(render("a.png", {"--no-inverse"}).exit_code, 0);
  EXPECT_EQ(file("view.png").rgba, file("a.png").rgba);
  ASSERT_EQ(render("inverse.png", {}).exit_code, 0);
  EXPECT_NE(read_text(m_folder / "view.png").find("\"inverse\":false"), std::string::npos);
  EXPECT_NE(read_text(m_folder / "a.png").find("\"inverse\":false"), std::string::npos);
  EXPECT_EQ(read_text(m_folder / "inverse.png").find("\"inverse\""), std::string::npos);
}

TEST_F(UnitWithoutInverse, ViewsWithAndWithoutInverseStandSideBySide) {
  const std::string look = "preset = \"Skin\"\nsize = [160, 160]\ncamera = { view = \"left\" }\n";
  const std::string step = "[[step]]\nrelease = true\n";
  const Outcome scene = view(step + "[[view]]\nimage = \"1.png\"\nafter_step = 0\n" + look +
                             "inverse = false\n[[view]]\nimage = \"2.png\"\nafter_step = 0\n" +
                             look + "[[view]]\nimage = \"3.png\"\ninverse = false\n" + look);
  ASSERT_EQ(scene.exit_code, 0) << scene.err;
  ASSERT_EQ(render("inverse.png", {}).exit_code, 0);
  ASSERT_EQ(render("a.png", {"--no-inverse"}).exit_code, 0);
  EXPECT_EQ(file("1.png").rgba, file("a.png").rgba);
  EXPECT_EQ(file("2.png").rgba, file("inverse.png").rgba);
  EXPECT_EQ(file("3.png").rgba, file("a.png").rgba);
}

TEST_F(PropertyWithoutInverse, HalfOfTheOffsetsGiveAlmostThePictureOfAll) {
  ASSERT_EQ(render("inverse_half.png", {}).exit_code, 0);
  const Outcome outcome = render("half.png", {"--half-offsets"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_GE(ssim_of("half.png"), 0.99);
  EXPECT_NE(file("half.png").rgba, file("inverse_half.png").rgba);
  const Outcome scene = view(
      "[[view]]\nimage = \"view.png\"\nhalf_offsets = true\npreset = \"Skin\"\n"
      "size = [160, 160]\ncamera = { view = \"left\" }\n");
  ASSERT_EQ(scene.exit_code, 0) << scene.err;
  EXPECT_EQ(file("view.png").rgba, file("half.png").rgba);
}

TEST_F(FaultWithoutInverse, HalfOfTheOffsetsNeedOffsets) {
  EXPECT_EQ(render("a.png", {"--half-offsets", "--no-inverse"}).exit_code, 2);
  EXPECT_EQ(render("a.png", {"--half-offsets", "--undeformed"}).exit_code, 2);
  expect_refused(render("a.png", {"--half-offsets"}, "small-head.nhdr"), 2,
                 "--half-offsets: found a volume");
  expect_refused(view("[[view]]\nimage = \"a.png\"\ninverse = false\nhalf_offsets = true\n"), 3,
                 "half_offsets without inverse");
}

TEST_F(FaultWithoutInverse, WhatNeedsAnInverseIsRefusedInOneLine) {
  write_text(m_folder / "twist.toml", "[path]\nfunction = \"twist\"\nangle = 20\n");
  EXPECT_EQ(render("a.png", {"--no-inverse", "--path", m_folder / "twist.toml"}).exit_code, 2);
  EXPECT_EQ(render("a.png", {"--no-inverse", "--undeformed"}).exit_code, 2);
  EXPECT_EQ(render("a.png", {"--no-inverse", "--offsets", m_folder / "no.mha"}).exit_code, 2);
  expect_refused(render("a.png", {"--no-inverse"}, "small-head.nhdr"), 2,
                 "--no-inverse: found a volume, expected a state file");
  const std::string key = "[[view]]\nimage = \"a.png\"\ninverse = false\n";
  expect_refused(view(key + "path = { function = \"twist\", angle = 20 }\n"), 3,
                 "view.toml:3: inverse: found sampling paths");
  expect_refused(view(key + "[path]\nfunction = \"twist\"\nangle = 20\n"), 3,
                 "view.toml:3: inverse: found sampling paths");
  expect_refused(view(key + "slice = {}\n"), 3, "inverse beside slice");
  EXPECT_FALSE(std::filesystem::exists(m_folder / "a.png"));
}

TEST_F(FaultWithoutInverse, AnOpenCutIsRefusedAndAClosedOneIsNot) {
  const std::string head =
      "[volume]\npath = \"small-head.nhdr\"\n[material]\ndomain = [-300, 1500]\nactive = [-300, "
      "3100]\n"
      "max_length = [[-300, 1.5]]\nmin_length = [[-300, 0.5]]\nshear = [[-300, 0.4]]\n"
      "[[step]]\ncut = [{ plane = { corner = [0, -140, -90], edge1 = [0, 120, 0], edge2 = [0, 0, "
      "90] } }]\n";
  const std::string aside = "[[step]]\ngrab_box = [49, 76, 6, 53, 79, 14]\nby = [14, 0, 0]\n";
  const auto run = [&](const std::string& name, const std::string& more) {
    write_text(m_folder / "knife.toml", head + more + "[output]\nstate = \"" + name + "\"\n");
    return run_supple({"run", m_folder / "knife.toml", "-o", m_folder / ""});
  };
  ASSERT_EQ(run("closed.vdb", "").exit_code, 0);
  const Outcome opening = run("open.vdb", aside);
  ASSERT_EQ(opening.exit_code, 0) << opening.err;
  const Outcome closed = render("a.png", {"--no-inverse"}, "closed.vdb");
  EXPECT_EQ(closed.exit_code, 0) << closed.err;
  expect_refused(render("b.png", {"--no-inverse"}, "open.vdb"), 3,
                 "--no-inverse: found cuts that have opened, expected a body without");
  const Outcome scene = run("no.vdb", aside + "[[view]]\nimage = \"b.png\"\ninverse = false\n");
  EXPECT_EQ(scene.exit_code, 3);
  EXPECT_NE(scene.err.find("knife.toml:14: inverse: found cuts that have opened"),
            std::string::npos)
      << scene.err;
  EXPECT_FALSE(std::filesystem::exists(m_folder / "b.png"));
}

}  // namespace
