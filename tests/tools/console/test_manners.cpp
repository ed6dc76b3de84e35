// Manners of the program: hints for what does not parse, help, handles, outputs, progress.
#include <filesystem>
#include <regex>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/base/error.h"
#include "volumes/base/files.h"

using namespace supple;
using namespace supple::test;

namespace {

class UnitManners : public ::testing::Test {
 protected:
  void SetUp() override {
    write_ball(m_folder, "ball", 16);
    write_soft_material(m_folder / "soft.toml");
  }
  Outcome deform(const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"deform",     m_folder / "ball.nhdr",
                                          "--material", m_folder / "soft.toml",
                                          "-o",         m_folder / "d.vdb"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_supple(arguments);
  }
  Outcome run_scene(const std::string& text, const std::vector<std::string>& more = {}) {
    write_text(m_folder / "scene.toml",
               "[volume]\npath = \"ball.nhdr\"\n[material]\ntable = \"soft.toml\"\n" + text);
    std::vector<std::string> arguments = {"run", m_folder / "scene.toml", "-o", m_folder / "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_supple(arguments);
  }
  static void expect(const Outcome& outcome, int exit_code, const std::vector<std::string>& parts) {
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    for (const std::string& part : parts) {
      EXPECT_NE((outcome.out + outcome.err).find(part), std::string::npos)
          << part << " in " << outcome.out << outcome.err;
    }
  }

  TemporaryFolder m_folder;
};

const std::string kStep = "[[step]]\ngrab = [8, 8, 8]\nby = [2.0, 0.0, 0.0]\n";

}  // namespace

TEST_F(UnitManners, MisspelledCommandsAndOptionsGetTheNearestName) {
  expect(run_supple({"defrom", "a"}), 2, {"'defrom'", "did you mean 'deform'?"});
  expect(run_supple({"xyzzyx"}), 2, {"'xyzzyx'", "info, probe, convert, compose, fit, crop"});
  expect(deform({"--grap", "8,8,8", "--by", "1,0,0"}), 2, {"--grap", "did you mean '--grab'?"});
  expect(deform({"--treads=2", "--grab", "8,8,8"}), 2, {"--treads", "did you mean '--threads'?"});
  expect(run_supple({"info", "--zzzzzzzz", "a"}), 2, {"--zzzzzzzz", "supple info --help"});
  expect(run_supple({"render", "a.nhdr", "--preset", "Bonee", "-o", "a.png"}), 2,
         {"--preset", "did you mean 'Bone'?"});
  expect(run_supple({"render", "a.nhdr", "--view", "lft", "-o", "a.png"}), 2, {"--view", "left"});
  expect(run_supple({"presets", "Bonee"}), 2, {"did you mean 'Bone'?"});
}

TEST_F(UnitManners, NumbersApartAndMillimetresGetAHint) {
  expect(deform({"--grab", "8", "8", "8", "--by", "1,0,0"}), 2,
         {"--grab: found 8 8 8, expected 8,8,8"});
  expect(deform({"--grab", "8,8,8", "--by", "1", "-2.5", "0"}), 2, {"--by", "1,-2.5,0"});
  expect(deform({"--grab", "8.5,3,-2", "--by", "1,0,0"}), 2, {"8.5,3,-2", "LPS mm", "x,y,z"});
  // Voxel 8,8,20 lies outside; as millimetres it is voxel 8,8,13, since slices are 1.5 mm apart.
  expect(deform({"--grab", "8,8,20", "--by", "1,0,0"}), 3,
         {"a voxel of the volume, 16,16,16", "as LPS mm it is voxel 8,8,13"});
}

TEST_F(UnitManners, AGrabBesideTheBodySaysDensityAndRange) {
  expect(deform({"--grab", "0,0,0", "--by", "1,0,0"}), 3,
         {"grab 0,0,0", "density 0, below the elements' 1 to 255", "the nearest is"});
  write_text(m_folder / "soft.toml",
             "domain = [0, 150]\nmax_length = [[0, 1.3]]\nmin_length = [[0, 0.7]]\n"
             "shear = [[0, 0.3]]\nactive = [1, 150]\n");
  expect(deform({"--grab", "8,8,8", "--by", "1,0,0"}), 3,
         {"density 200, above the elements' 1 to 150"});
  expect(deform({"--fix", "8,8,8"}), 3, {"fix 8,8,8", "density 200, above"});
}

TEST_F(UnitManners, DeformTellsVoxelPlaceDensityAndLabelOfEveryHandle) {
  write_text(m_folder / "labels.raw", std::string(16 * 16 * 16, char(3)));
  std::string header = read_text(m_folder / "ball.nhdr");
  header.replace(header.find("ball.raw"), 8, "labels.raw");
  write_text(m_folder / "labels.nhdr", header);
  const std::vector<std::string> drag = {"--grab", "8,8,8",    "--by",
                                         "1,0,0",  "--labels", m_folder / "labels.nhdr"};
  expect(deform(drag), 0,
         {"grab 8,8,8", "element at voxel 8,8,8, LPS 8, 8, 12 mm, density 200, label 3"});
  std::vector<std::string> as_json = drag;
  as_json.insert(as_json.end(), {"--json", "--force"});
  const auto handle = nlohmann::json::parse(deform(as_json).out)["handles"][0];
  EXPECT_EQ(handle["grab"], "8,8,8");
  EXPECT_EQ(handle["elements"], 1);
  EXPECT_EQ(handle["lps_mm"], nlohmann::json({8.0, 8.0, 12.0}));
  EXPECT_EQ(handle["density"], nlohmann::json({200.0, 200.0}));
  EXPECT_EQ(handle["labels"], nlohmann::json({3}));
}

TEST_F(UnitManners, HelpIsWrappedAndNamesTheOptionsThatEveryCommandTakes) {
  for (const char* command : {"deform", "render", "info", "bench", "help"}) {
    const Outcome outcome = run_supple({"help", command});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, run_supple({command, "--help"}).out);
    const std::size_t everywhere = outcome.out.find("Everywhere, see supple --help: --threads");
    EXPECT_NE(everywhere, std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("--force", everywhere), std::string::npos);
    const std::string options = outcome.out.substr(0, outcome.out.find("Examples:"));
    std::istringstream lines(options);
    for (std::string line; std::getline(lines, line);) {
      std::size_t columns = 0;
      for (const char c : line) columns += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
      EXPECT_LE(columns, 100u) << line;
    }
  }
  EXPECT_EQ(run_supple({"help"}).out, run_supple({"--help"}).out);
  expect(run_supple({"help", "defrom"}), 2, {"did you mean 'deform'?"});
}

TEST_F(UnitManners, TheVersionNamesCommitAndLibraries) {
  const Outcome outcome = run_supple({"-V"});
  EXPECT_EQ(outcome.out, run_supple({"--version"}).out);
  EXPECT_TRUE(std::regex_search(outcome.out, std::regex("^supple [0-9.]+, commit [0-9a-f]{12}\n")))
      << outcome.out;
  EXPECT_TRUE(std::regex_search(outcome.out, std::regex("OpenVDB [0-9]+\\.[0-9]+\\.[0-9]+")));
}

TEST_F(UnitManners, ManualAndCompletionHoldEveryOption) {
  const std::string manual = run_supple({"help", "--manual"}).out;
  write_text(m_folder / "supple.1", manual);
  for (const char* name : {"\\-\\-springs\\-time", "\\-\\-classification", "\\-\\-log\\-level"}) {
    EXPECT_NE(manual.find(name), std::string::npos) << name;
  }
  if (runs("command -v groff")) {
    EXPECT_TRUE(runs("groff -man -Tutf8 -ww " + m_folder / "supple.1"));
  }
  write_text(m_folder / "supple.bash", run_supple({"help", "--completion"}).out);
  const auto completes = [&](const std::string& words, int word, const std::string& expected) {
    return runs("bash -c 'source " + m_folder / "supple.bash" + " && COMP_WORDS=(" + words +
                ") COMP_CWORD=" + std::to_string(word) +
                " && _supple && [[ \" ${COMPREPLY[*]} \" == *\" " + expected + " \"* ]]'");
  };
  EXPECT_TRUE(completes("supple def", 1, "deform"));
  EXPECT_TRUE(completes("supple deform a --springs-ti", 3, "--springs-time"));
  EXPECT_TRUE(completes("supple render a --quality acc", 4, "accurate"));
  EXPECT_FALSE(completes("supple render a --springs-ti", 3, "--springs-time"));
  EXPECT_EQ(run_supple({"help", "--completion", "bash"}).out,
            run_supple({"help", "--completion"}).out);
  expect(run_supple({"help", "--completion", "csh"}), 2, {"csh"});
}

TEST_F(UnitManners, FishCompletesCommandsOptionsAndWords) {
  if (!runs("command -v fish")) GTEST_SKIP() << "fish is not installed";
  const std::string file = m_folder / "supple.fish";
  write_text(file, run_supple({"help", "--completion", "fish"}).out);
  EXPECT_TRUE(runs("fish -n " + file));
  const auto completes = [&](const std::string& line, const std::string& expected) {
    return runs("HOME=" + m_folder / "home" + " fish -c 'source " + file + "; complete -C \"" +
                line + "\"' | grep -q -- '^" + expected + "'");
  };
  EXPECT_TRUE(completes("supple def", "deform"));
  EXPECT_TRUE(completes("supple deform a --springs-ti", "--springs-time"));
  EXPECT_TRUE(completes("supple render a --quality acc", "accurate"));
  EXPECT_FALSE(completes("supple render a --springs-ti", "--springs-time"));
}

TEST_F(UnitManners, ZshCompletesCommandsOptionsAndWords) {
  if (!runs("command -v zsh")) GTEST_SKIP() << "zsh is not installed";
  const std::string file = m_folder / "_supple";
  write_text(file, run_supple({"help", "--completion", "zsh"}).out);
  EXPECT_TRUE(runs("zsh -n " + file));
  // Prints all that the script hands on to zsh, which completes in a terminal only.
  write_text(m_folder / "ask.zsh",
             "_describe() { print -l -- ${(P)@[-1]} }\n"
             "compadd() { print -l -- ${@[2,-1]} }\n"
             "_files() { print files }\n"
             "complete() { local -a words; words=(supple \"$@\"); local CURRENT=$#words\n" +
                 run_supple({"help", "--completion", "zsh"}).out + "}\ncomplete \"$@\"\n");
  const auto completes = [&](const std::string& words, const std::string& expected) {
    return runs("zsh -f " + m_folder / "ask.zsh" + " " + words + " | grep -q -- '^" + expected +
                "'");
  };
  EXPECT_TRUE(completes("def", "deform:"));
  EXPECT_TRUE(completes("deform a --springs-ti", "--springs-time:"));
  EXPECT_TRUE(completes("render a --quality acc", "accurate$"));
  EXPECT_TRUE(completes("render a.nrrd", "files"));
  EXPECT_FALSE(completes("render a --springs-ti", "--springs-time:"));
}

TEST_F(UnitManners, EveryFileThatIsWrittenIsToldWithItsSize) {
  const Outcome outcome = deform({"--grab", "8,8,8", "--by", "1,0,0"});
  const auto bytes = std::filesystem::file_size(m_folder / "d.vdb");
  char size[32];
  std::snprintf(size, sizeof size, "%.4g kB", double(bytes) / 1000);
  expect(outcome, 0, {"supple: wrote " + m_folder / "d.vdb" + ", " + size + ", after "});
  const std::string warp = m_folder / "w.nhdr";
  expect(run_supple({"export", m_folder / "d.vdb", "-o", warp}), 0,
         {"wrote " + warp, "wrote " + m_folder / "w.raw"});
  EXPECT_EQ(run_supple({"export", m_folder / "d.vdb", "-o", warp, "--force", "--quiet"}).err, "");
}

TEST_F(UnitManners, ADryRunChecksHandlesAgainstTheVolume) {
  const Outcome good = run_scene(kStep + "[output]\nstate = \"a.vdb\"\n", {"--dry-run", "--json"});
  ASSERT_EQ(good.exit_code, 0) << good.err;
  const auto plan = nlohmann::json::parse(good.out);
  EXPECT_EQ(plan["steps"][0]["handles"][0]["density"], nlohmann::json({200.0, 200.0}));
  EXPECT_EQ(plan["outputs"][0], m_folder / "out/a.vdb");
  expect(run_scene("[[step]]\ngrab = [0, 0, 0]\nby = [2.0, 0.0, 0.0]\n", {"--dry-run"}), 3,
         {"scene.toml:5", "grab 0,0,0", "density 0, below"});
  expect(run_scene("[[step]]\nfix = [[0, 0, 0]]\n", {"--dry-run"}), 3, {"fix 0,0,0"});
  EXPECT_FALSE(std::filesystem::exists(m_folder / "out"));
}

TEST_F(UnitManners, ADryRunNeedsNoOutputAndMindsNoneThatExists) {
  const std::string existing = m_folder / "d.vdb";
  write_text(existing, "kept");
  const auto dry = [&](std::vector<std::string> words) {
    words.push_back("--dry-run");
    const Outcome outcome = run_supple(words);
    EXPECT_EQ(outcome.exit_code, 0) << words.front() << outcome.err;
    return outcome.out;
  };
  const std::string ball = m_folder / "ball.nhdr";
  EXPECT_NE(dry({"deform", ball, "--grab", "8,8,8", "--by", "1,0,0"}).find("state.vdb"),
            std::string::npos);
  dry({"deform", ball, "--grab", "8,8,8", "--by", "1,0,0", "-o", existing});
  dry({"render", ball});
  EXPECT_EQ(read_text(existing), "kept");
  expect(run_supple({"deform", ball, "--grab", "8,8,8", "--by", "1,0,0"}), 2,
         {"--output is required"});
}

TEST_F(UnitManners, ANamedViewMayHaveAnAngleAndOtherWordsForItsSide) {
  const std::string view = "[[view]]\nimage = \"a.png\"\nsize = [48, 48]\ncamera = ";
  const auto picture = [&](const std::string& camera) {
    const Outcome outcome = run_scene(view + camera + "\n", {"--force"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read_text(m_folder / "out/a.png");
  };
  const std::string front = picture("{ view = \"front\" }");
  EXPECT_EQ(front, picture("{ view = \"anterior\" }"));
  EXPECT_NE(front, picture("{ view = \"front\", fov = 80.0 }"));
  expect(run_scene(view + "{ view = \"front\", fov = 190.0 }\n", {"--force"}), 3, {"fov", "190"});
  expect(run_scene(view + "{ view = \"front\", up = [1.0, 0.0, 0.0] }\n", {"--force"}), 3,
         {"view beside position"});
  const auto slice = [&](const std::string& plane) {
    EXPECT_EQ(run_supple({"slice", m_folder / "ball.nhdr", "--plane", plane, "--force", "-o",
                          m_folder / "s.png"})
                  .exit_code,
              0);
    return read_text(m_folder / "s.png");
  };
  EXPECT_EQ(slice("transverse"), slice("axial"));
}

TEST_F(UnitManners, WhatSlicesDoNotHaveIsRefusedBesideThem) {
  const std::string view = "[[view]]\nimage = \"a.png\"\nslice = { plane = \"axial\" }\n";
  for (const char* key : {"light = [{ direction = [0.0, -1.0, 0.0] }]", "shadows = true",
                          "preset = \"Bone\"", "clip_meshes = true", "offset_max = 3.0"}) {
    expect(run_scene(view + key + "\n"), 3, {"beside slice"});
  }
  expect(run_scene(view + "deformed = false\nafter_step = 0\n"), 0, {});
}

TEST_F(UnitManners, ATimeSeriesIsDescribedByItsFirstFrame) {
  write_text(m_folder / "t.nrrd",
             "NRRD0004\ntype: uint8\ndimension: 4\nspace: LPS\nsizes: 2 2 1 3\n"
             "space directions: (1,0,0) (0,1,0) (0,0,1) none\nkinds: domain domain domain list\n"
             "encoding: raw\n\nabcdefghijkl");
  const Outcome outcome = run_supple({"info", m_folder / "t.nrrd", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["frames"], 3);
  EXPECT_EQ(json["frame"], 0);
  EXPECT_EQ(json["max"], 'd');
  const auto last = nlohmann::json::parse(
      run_supple({"info", m_folder / "t.nrrd", "--json", "--frame", "2"}).out);
  EXPECT_EQ(last["frame"], 2);
  EXPECT_EQ(last["max"], 'l');
  expect(run_supple({"convert", m_folder / "t.nrrd", m_folder / "c.nrrd"}), 3, {"3 frames"});
}

TEST_F(UnitManners, NumbersForPeopleHaveFourDigits) {
  const Outcome info = run_supple({"info", m_folder / "ball.nhdr"});
  const double mean =
      nlohmann::json::parse(run_supple({"info", "--json", m_folder / "ball.nhdr"}).out)["mean"];
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", mean);
  EXPECT_TRUE(std::regex_search(info.out, std::regex("mean +" + std::string(text) + "\n")))
      << info.out;
  EXPECT_FALSE(std::regex_search(info.out, std::regex("[0-9]\\.[0-9]{5}"))) << info.out;
}

TEST_F(UnitManners, ResultsFollowTheProgressLineOfATerminal) {
  // A terminal shows the part of a line that follows the last return to its start.
  write_text(m_folder / "terminal.py",
             "import os, pty, sys\n"
             "seen = b''\n"
             "def read(fd):\n"
             "    global seen\n"
             "    data = os.read(fd, 1024)\n"
             "    seen += data\n"
             "    return data\n"
             "status = pty.spawn(sys.argv[1:], read)\n"
             "assert status == 0, status\n"
             "text = seen.decode().replace('\\r\\n', '\\n')\n"
             "assert '\\r\\033[K' in text, 'no progress was shown'\n"
             "shown = [line.split('\\r\\033[K')[-1] for line in text.split('\\n')]\n"
             "assert any(line.startswith('elements  ') for line in shown), shown\n"
             "assert any(line.startswith('grab 8,8,8') for line in shown), shown\n"
             "assert shown[-1] == '', shown\n");
  const char* binary = std::getenv("SUPPLE_BINARY");
  EXPECT_TRUE(runs_python(m_folder / "terminal.py" + " " + binary + " deform " +
                          m_folder / "ball.nhdr" + " --material " + m_folder / "soft.toml" +
                          " --grab 8,8,8 --by 1,0,0 -o " + m_folder / "d.vdb"));
}

TEST_F(UnitManners, WithoutATerminalProgressIsLinesAsOftenAsAsked) {
  ::setenv("SUPPLE_PROGRESS_SECONDS", "0", 1);
  const Outcome often = run_supple({"info", m_folder / "ball.nhdr"});
  const Outcome quiet = run_supple({"info", m_folder / "ball.nhdr", "--quiet"});
  ::unsetenv("SUPPLE_PROGRESS_SECONDS");
  EXPECT_NE(often.err.find("supple: reading 100 %"), std::string::npos) << often.err;
  EXPECT_EQ(often.err.find('\r'), std::string::npos);
  EXPECT_EQ(quiet.err, "");
  EXPECT_EQ(run_supple({"info", m_folder / "ball.nhdr"}).err, "") << "every ten seconds by default";
}

namespace {

class FaultSharedNames : public UnitManners {};

}  // namespace

TEST_F(FaultSharedNames, AFileThatAnotherProcessIsAboutToWriteIsRefused) {
  RUN_WHEN_SANITIZED();
  const std::string copy = m_folder / "copy.nrrd";
  const std::vector<std::string> convert = {"convert", m_folder / "ball.nhdr", copy};
  {
    ReservedNames other;
    other.add(copy);
    ReservedNames neighbour;  // leaves before the other does
    neighbour.add(m_folder / "free.nrrd");
    EXPECT_THROW(neighbour.add(copy), SystemError);
    expect(run_supple(convert), 4, {copy + ": another process is about to write this file"});
    EXPECT_FALSE(std::filesystem::exists(copy));
  }
  expect(run_supple(convert), 0, {});
  EXPECT_EQ(m_folder.entries(),
            (std::vector<std::string>{"ball.nhdr", "ball.raw", "copy.nrrd", "soft.toml"}));
}

TEST_F(FaultSharedNames, OfFourProcessesOneWritesAndTheOthersSaySo) {
  RUN_WHEN_SANITIZED();
  // Large enough that all four have begun before the first is done.
  write_ball(m_folder, "large", 96);
  const std::string binary = std::getenv("SUPPLE_BINARY");
  const std::string command = binary + " deform " + m_folder / "large.nhdr" + " --material " +
                              m_folder / "soft.toml" + " --grab 48,48,48 --by 9,0,0 -o " +
                              m_folder / "d.vdb";
  ASSERT_TRUE(runs("for n in 1 2 3 4; do (" + command + " 2> " + m_folder / "err$n" +
                   "; echo $? > " + m_folder / "code$n" + ") & done; wait"));
  int done = 0;
  for (const char* n : {"1", "2", "3", "4"}) {
    const std::string code = read_text(m_folder / (std::string("code") + n));
    const std::string err = read_text(m_folder / (std::string("err") + n));
    done += code == "0\n";
    if (code == "0\n") continue;
    EXPECT_TRUE(code == "4\n" || code == "2\n") << code;
    EXPECT_NE(err.find("d.vdb: "), std::string::npos) << err;
  }
  EXPECT_EQ(done, 1);
}

TEST_F(FaultSharedNames, WhatKilledProcessesLeftGoesWithTheNextRun) {
  RUN_WHEN_SANITIZED();
  // No process has the largest number that the kernel allows.
  const std::string gone = ".supple-4194304-copy.nrrd", mine = ".supple-1-copy.nrrd";
  write_text(m_folder / gone, "left");
  write_text(m_folder / mine, "of a process that runs");
  write_text(m_folder / ".supple.lock", "");
  write_text(m_folder / ".supple-4194304-other.nrrd", "of another output");
  expect(run_supple({"convert", m_folder / "ball.nhdr", m_folder / "copy.nrrd"}), 0, {});
  EXPECT_EQ(m_folder.entries(),
            (std::vector<std::string>{mine, ".supple-4194304-other.nrrd", "ball.nhdr", "ball.raw",
                                      "copy.nrrd", "soft.toml"}));
}

TEST_F(FaultSharedNames, FoldersMadeForOutputsThatFailAreGone) {
  RUN_WHEN_SANITIZED();
  const Outcome outcome = run_scene(kStep + kStep + "[output]\nstate = \"a/b.vdb\"\n" +
                                    "volumes = [\"a/v.nrrd\"]\n[[step]]\ngrab = [0, 0, 0]\n"
                                    "by = [1.0, 0.0, 0.0]\n");
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(m_folder / "out"));
}
