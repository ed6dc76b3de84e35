#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple::test;

namespace {

const std::vector<std::string> kCommands = {
    "info",     "convert", "deform", "render",  "slice",  "presets", "keys",          "export",
    "resample", "apply",   "run",    "compare", "invert", "metrics", "probe",         "tradeoff",
    "stress",   "bench",   "help",   "mesh",    "sweep",  "cohort",  "slicer-module", "straighten"};

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

}  // namespace

TEST(UnitCommandLine, HelpGoesToStdoutInEightyLinesWithThreeExamples) {
  for (const std::string& command : kCommands) {
    const Outcome outcome = run_supple({command, "--help"});
    EXPECT_EQ(outcome.exit_code, 0) << command;
    EXPECT_TRUE(outcome.err.empty()) << command;
    EXPECT_LE(count_of(outcome.out, "\n"), 80u) << command;
    EXPECT_EQ(count_of(outcome.out.substr(outcome.out.find("Examples:")), "\n  supple "), 3u)
        << command << outcome.out;
  }
  EXPECT_EQ(run_supple({"--help"}).exit_code, 0);
  EXPECT_EQ(run_supple({"--version"}).exit_code, 0);
}

TEST(UnitCommandLine, AWrongCommandLineIsOneLineAndExitCodeTwo) {
  const std::vector<std::vector<std::string>> cases = {
      {},
      {"frobnicate"},
      {"info"},
      {"info", "a", "--no-such-option"},
      {"deform", "a.nhdr"},
      {"deform", "a.nhdr", "--grab", "1,2", "--by", "0,0,0", "-o", "x.vdb"},
      {"deform", "a.nhdr", "--grab", "1,2,3", "-o", "x.vdb"},
      {"deform", "a.nhdr", "--grab", "1,2,3", "--by", "a,b,c", "-o", "x.vdb"},
      {"deform", "a.nhdr", "--fix", "1,2,3:4", "-o", "x.vdb"},
      {"export", "a.vdb", "-o", "x.nrrd", "--direction", "sideways"},
      {"export", "a.vdb", "-o", "x.nrrd", "--direction", "material", "--void", "extend"},
      {"bench"},
      {"bench", "frobnicate"},
      {"bench", "ecm", "--only"},
      {"infoo", "a.nhdr"},
      {"info", "a", "--log-level", "loud"},
      {"render", "a.nhdr", "-o", "x.png", "--size", "big"},
      {"info", "a", "--threads", "-1"}};
  for (const auto& arguments : cases) {
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << ::testing::PrintToString(arguments) << outcome.err;
    EXPECT_EQ(count_of(outcome.err, "\n"), 1u) << outcome.err;
    EXPECT_TRUE(outcome.out.empty());
  }
}

TEST(UnitCommandLine, InfoOfSeveralFilesDescribesThemAllAndNamesThoseThatItCannotRead) {
  RUN_WHEN_SANITIZED();
  const TemporaryFolder folder;
  write_ball(folder, "ball", 16);
  write_ball(folder, "small", 8);
  const std::string ball = folder / "ball.nhdr", none = folder / "none.nrrd",
                    small = folder / "small.nhdr";
  const Outcome outcome = run_supple({"info", "--json", ball, none, small});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_EQ(count_of(outcome.err, "\n"), 1u) << outcome.err;
  EXPECT_EQ(outcome.err.find("supple: error: " + none), 0u) << outcome.err;
  auto json = nlohmann::json::parse(outcome.out);
  ASSERT_EQ(json.size(), 3u);
  EXPECT_EQ(json[0]["file"], ball);
  EXPECT_EQ(json[0]["dims"], nlohmann::json({16, 16, 16}));
  EXPECT_EQ(json[1]["file"], none);
  EXPECT_EQ(json[1]["exit_code"], 3);
  EXPECT_EQ("supple: error: " + json[1]["error"].get<std::string>() + "\n", outcome.err);
  EXPECT_EQ(json[2]["file"], small);
  json[2].erase("file");
  EXPECT_EQ(json[2], nlohmann::json::parse(run_supple({"info", "--json", small}).out));

  const Outcome text = run_supple({"info", small, ball});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_LT(text.out.find(small), text.out.find(ball));
  EXPECT_NE(text.out.find(ball), std::string::npos);
  EXPECT_EQ(run_supple({"info", small, ball, "--raw", "dims=1"}).exit_code, 3);
}

TEST(UnitCommandLine, InfoAsJsonHasTheDocumentedFields) {
  RUN_WHEN_SANITIZED();
  const TemporaryFolder folder;
  write_ball(folder, "ball", 16);
  const Outcome outcome = run_supple({"info", "--json", folder / "ball.nhdr"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["format"], "nrrd");
  EXPECT_EQ(json["type"], "uint8");
  EXPECT_EQ(json["dims"], nlohmann::json({16, 16, 16}));
  EXPECT_EQ(json["spacing_mm"], nlohmann::json({1.0, 1.0, 1.5}));
  EXPECT_EQ(json["direction"][2][2], 1.0);
  EXPECT_EQ(json["affine_lps"][2][2], 1.5);
  EXPECT_EQ(json["affine_lps"][3][3], 1.0);
  EXPECT_EQ(json["min"], 0.0);
  EXPECT_EQ(json["max"], 200.0);
  EXPECT_EQ(json["bytes_dense"], 16 * 16 * 16);
  EXPECT_GT(json["active_voxels"], 0);
  EXPECT_GT(json["bytes_sparse"], 0);
  EXPECT_EQ(json["sha256"].get<std::string>().size(), 64u);
}

TEST(UnitCommandLine, ExistingOutputsNeedForce) {
  const TemporaryFolder folder;
  write_ball(folder, "ball", 16);
  write_soft_material(folder / "soft.toml");
  write_text(folder / "out.vdb", "precious");
  std::vector<std::string> arguments = {"deform",     folder / "ball.nhdr",
                                        "--material", folder / "soft.toml",
                                        "--grab",     "8,8,8",
                                        "--by",       "3,0,0",
                                        "-o",         folder / "out.vdb"};
  EXPECT_EQ(run_supple(arguments).exit_code, 2);
  EXPECT_EQ(read_text(folder / "out.vdb"), "precious");
  arguments.push_back("--force");
  EXPECT_EQ(run_supple(arguments).exit_code, 0);
  EXPECT_NE(read_text(folder / "out.vdb"), "precious");
}

TEST(UnitCommandLine, NegativeNumbersAreValuesNotOptions) {
  const TemporaryFolder folder;
  write_ball(folder, "ball", 16);
  write_soft_material(folder / "soft.toml");
  const Outcome outcome =
      run_supple({"deform", "--grab", "8,8,8", "--by", "-3.5,-1,0", folder / "ball.nhdr",
                  "--material", folder / "soft.toml", "--json", "-o", folder / "out.vdb"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  for (const char* key : {"fraction", "moved", "projected", "folded", "certificate"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_GT(json["moved"], 1);
  EXPECT_LE(json["certificate"]["residual_max_voxels"], 1e-3);
}

TEST(UnitCommandLine, ErrorsTellTheNearestNameAndTheHelpOfTheCommand) {
  const TemporaryFolder folder;
  write_ball(folder, "ball", 16);
  const Outcome wrong = run_supple({"deform", folder / "ball.nhdr", "--material", "ct-heat",
                                    "--grab", "8,8,8", "--by", "1,0,0", "-o", folder / "x.vdb"});
  EXPECT_EQ(wrong.exit_code, 3);
  for (const char* words : {"--material", "'ct-heat'", "mr-brain", "did you mean 'ct-head'?"}) {
    EXPECT_NE(wrong.err.find(words), std::string::npos) << wrong.err;
  }
  const Outcome incomplete = run_supple({"deform", folder / "ball.nhdr", "--grab", "8,8,8"});
  EXPECT_NE(incomplete.err.find("see supple deform --help"), std::string::npos) << incomplete.err;
  const Outcome probe = run_supple(
      {"probe", folder / "ball.nhdr", "--at", "8,8,8", "--material", "mr-brain", "--json"});
  EXPECT_EQ(probe.exit_code, 0) << probe.err;
}
