// supple slicer-module: descriptions judged by their schema and against help, and modules run from
// them alone, with progress and without leftovers.
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <regex>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple::test;

namespace {

namespace fs = std::filesystem;

class SlicerModules : public testing::Test {
 protected:
  SlicerModules() {
    fs::create_directory(m_folder / "my scans");
    m_folder.write("my scans/pins.csv", "x,y,z\n2,2,2\n9,2,2\n2,9,2\n2,2,9\n9,9,9\n");
    m_folder.write("my scans/pulled.csv", "x,y,z\n2,2,2\n9,3,2\n2,9,3\n3,2,9\n9,9,9\n");
    write_ball(m_folder, "ball", 12);
    const Outcome outcome = run_supple({"fit", "--points", in("pins.csv"), in("pulled.csv"),
                                        "--grid", m_folder / "ball.nhdr", "-o", in("a warp.h5")});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  std::string in(const std::string& name) const { return m_folder / ("my scans/" + name); }
  static Outcome drive(std::vector<std::string> words) {
    std::vector<std::string> all = {"/usr/bin/python3",
                                    source_dir() + "/tests/tools/console/slicer_driver.py"};
    words.insert(words.begin() + 1, std::getenv("SUPPLE_BINARY"));
    all.insert(all.end(), words.begin(), words.end());
    return run_program(all);
  }

  const TemporaryFolder m_folder;
};

using InteropSlicerModules = SlicerModules;
using FaultSlicerModules = SlicerModules;

TEST_F(InteropSlicerModules, DescriptionsAreValidAndEveryFlagIsThatOfTheCommand) {
  const std::pair<const char*, const char*> modules[] = {
      {"deform", "deform"},      {"finite-elements", "deform"}, {"invert", "invert"},
      {"apply-points", "apply"}, {"apply-mesh", "apply"},       {"apply-labels", "apply"}};
  for (const auto& [module, command] : modules) {
    const Outcome outcome = drive({"check", module, command});
    EXPECT_EQ(outcome.exit_code, 0) << module << outcome.err;
  }
}

TEST_F(InteropSlicerModules, InvertRunsFromItsDescriptionAndTellsProgress) {
  RUN_WHEN_SANITIZED();
  const Outcome outcome = drive({"run", "invert", "field=" + in("a warp.h5"),
                                 "output=" + in("its inverse.nrrd"), "void=outside"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  ASSERT_EQ(
      run_supple({"invert", in("a warp.h5"), "--void", "outside", "-o", in("same.nrrd")}).exit_code,
      0);
  EXPECT_EQ(read_text(in("its inverse.nrrd")), read_text(in("same.nrrd")));
  const std::regex stage(
      "<filter-start>\n<filter-name>([^<]+)</filter-name>\n<filter-comment>[^<]+</filter-comment>\n"
      "</filter-start>\n(<filter-progress>(0\\.[0-9]+|1\\.00)</filter-progress>\n)*"
      "[^<]*<filter-end>\n<filter-name>([^<]+)</filter-name>\n"
      "<filter-time>[0-9.]+</filter-time>\n</filter-end>\n");
  int stages = 0;
  for (std::sregex_iterator at(outcome.out.begin(), outcome.out.end(), stage), end; at != end;
       ++at) {
    EXPECT_EQ((*at)[1], (*at)[4]);
    ++stages;
  }
  EXPECT_GE(stages, 2) << outcome.out;
  EXPECT_EQ(std::regex_replace(outcome.out, stage, "").find('<'), std::string::npos) << outcome.out;
}

TEST_F(InteropSlicerModules, DeformAndFiniteElementsTakePointsAndMakeATransform) {
  RUN_WHEN_SANITIZED();
  m_folder.write("my scans/from.csv", "x,y,z\n7,6,6\n");
  m_folder.write("my scans/to.csv", "x,y,z\n7.5,6,6\n");
  m_folder.write("my scans/stay.csv", "x,y,z\n4,6,6\n");
  write_soft_material(in("soft.toml"));
  const std::vector<std::string> command = {
      "deform", m_folder / "ball.nhdr", "--material", in("soft.toml"), "--grab", in("from.csv"),
      "--to",   in("to.csv"),           "--fix",      in("stay.csv")};
  for (const char* module : {"deform", "finite-elements"}) {
    const bool is_fem = module == std::string("finite-elements");
    const Outcome outcome =
        drive({"run", module, "input=" + (m_folder / "ball.nhdr"), "material=" + in("soft.toml"),
               "grab=" + in("from.csv"), "to=" + in("to.csv"), "fix=" + in("stay.csv"),
               "output=" + in("slicer's.nrrd"), "moved=" + in("slicer's moved.nrrd")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    std::vector<std::string> words = command;
    words.insert(words.end(), {"--force", "-o", in("ours.nrrd")});
    if (is_fem) words.insert(words.end(), {"--model", "fem"});
    ASSERT_EQ(run_supple(words).exit_code, 0);
    EXPECT_EQ(read_text(in("slicer's.nrrd")), read_text(in("ours.nrrd"))) << module;
    EXPECT_TRUE(fs::exists(in("slicer's moved.nrrd")));
  }
}

TEST_F(InteropSlicerModules, ApplyTakesFiducialsInLpsMillimetres) {
  const auto list = [](const char* frame, const char* place) {
    return std::string("# Markups fiducial file version = 4.11\n# CoordinateSystem = ") + frame +
           "\n# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\nF-1," +
           place + ",0,0,0,1,1,1,0,F-1,,\n";
  };
  m_folder.write("my scans/lps.fcsv", list("LPS", "4,5,6"));
  m_folder.write("my scans/ras.fcsv", list("RAS", "-4,-5,6"));
  m_folder.write("my scans/plain.csv", "x,y,z\n4,5,6\n");
  ASSERT_EQ(
      run_supple({"apply", in("a warp.h5"), "--points", in("plain.csv"), "-o", in("moved.csv")})
          .exit_code,
      0);
  const auto place_in = [&](const std::string& name, const std::string& before) {
    const std::string text = read_text(in(name));
    std::vector<double> place(3, NAN);
    const std::size_t at = text.find(before);
    EXPECT_NE(at, std::string::npos) << text;
    if (at == std::string::npos) return place;
    std::sscanf(text.c_str() + at + before.size(), "%lf,%lf,%lf", &place[0], &place[1], &place[2]);
    return place;
  };
  const std::vector<double> expected = place_in("moved.csv", "x,y,z\n");
  EXPECT_GT(std::abs(expected[0] - 4) + std::abs(expected[1] - 5), 0.01);
  for (const char* frame : {"lps", "ras"}) {
    const std::string out = std::string("moved ") + frame + ".fcsv";
    const Outcome outcome =
        drive({"run", "apply-points", "deformation=" + in("a warp.h5"),
               "points=" + in(std::string(frame) + ".fcsv"), "output=" + in(out)});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const double sign = frame == std::string("lps") ? 1 : -1;
    const std::vector<double> place = place_in(out, "F-1,");
    EXPECT_NEAR(place[0], sign * expected[0], 1e-6);
    EXPECT_NEAR(place[1], sign * expected[1], 1e-6);
    EXPECT_NEAR(place[2], expected[2], 1e-6);
  }
}

TEST_F(FaultSlicerModules, SigtermLeavesNothingAndWrongArgumentsAreOneLine) {
  const auto module = [&](std::vector<std::string> words, const RunOptions& options = {}) {
    words.insert(words.begin(), "slicer-module");
    return run_supple(words, options);
  };
  std::set<std::string> before, after;
  for (const auto& entry : fs::directory_iterator(m_folder / "my scans"))
    before.insert(entry.path());
  RunOptions options;
  options.interrupt_at_file = in(".supple.lock");
  options.interrupt_after_s = 0.02;
  options.interrupt_by = SIGTERM;
  const Outcome ended = module({"invert", "--field", in("a warp.h5"), "--output", in("o.h5"),
                                "--grid", m_folder / "ball.nhdr", "--margin", "60"},
                               options);
  EXPECT_EQ(ended.exit_code, 128 + SIGTERM) << ended.err;
  for (const auto& entry : fs::directory_iterator(m_folder / "my scans"))
    after.insert(entry.path());
  EXPECT_EQ(after, before);
  EXPECT_NE(module({"inwert", "--xml"})
                .err.find("found 'inwert', expected deform, finite-elements, invert, apply-points"),
            std::string::npos);
  const Outcome unknown = module({"invert", "--fields", "a"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("--fields: found no option of the module invert"), std::string::npos)
      << unknown.err;
  EXPECT_EQ(module({"invert", "--field"}).exit_code, 2);
  const Outcome missing = module({"invert", "--field", in("none.h5"), "--output", in("o.h5"),
                                  "--returnparameterfile", in("r.txt"), "--void", "default"});
  EXPECT_EQ(missing.exit_code, 3) << missing.err;
  EXPECT_NE(missing.err.find("none.h5: found no such file"), std::string::npos) << missing.err;
}

}  // namespace
