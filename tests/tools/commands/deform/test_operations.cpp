// Operations as users have them: what a run writes, that it is the same each time, and what is
// refused.
#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lib/operation/operation_log.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/base/files.h"
#include "volumes/base/json.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr char kOperation[] = R"([operation]
duration = 1

[eye]
incisions = [{ name = "temporal", at = [8.2, -2.4, 6.9] }, { name = "nasal", at = [-8.2, -2.4, 6.9] }]

[[body]]
kind = "membrane"
name = "membrane"
sheet = { radius = 2, nodes = 60 }

[[instrument]]
name = "needle"
kind = "needle"
incision = "temporal"
hand = { tremor = 0.05, seed = 3 }
way = [
  { time = 0, tip = [1, 0, -9] },
  { time = 1, tip = [-1, 0, -10.9] },
]

[[instrument]]
name = "lamp"
kind = "lamp"
incision = "nasal"
way = [{ time = 0, tip = [-3, -1, -2], active = 1 }]

[[task]]
kind = "navigate"
instrument = "needle"
targets = [{ at = [0.8, 0, -9.2], radius = 1, hold = 0.1 }]

[[view]]
image = "end.png"
video = "all_%02d.png"
size = [48, 36]

[output]
log = "log.jsonl"
score = "score.json"
tracks = "track_%s.csv"
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

class OperationCli : public ::testing::Test {
 protected:
  Outcome supple_of(const std::string& command, const std::string& scene,
                    std::vector<std::string> more, const RunOptions& options = {}) const {
    write_text(m_folder / "scene.toml", scene);
    more.insert(more.begin(), {command, m_folder / "scene.toml"});
    return run_supple(more, options);
  }
  Outcome run(const std::string& scene, const std::vector<std::string>& more = {},
              const RunOptions& options = {}) const {
    std::vector<std::string> all = {"-o", m_folder / "out"};
    all.insert(all.end(), more.begin(), more.end());
    return supple_of("run", scene, all, options);
  }
  /// The state to which a command leads.
  std::string digest_of(const Outcome& outcome) const {
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.exit_code == 0 ? std::string(nlohmann::json::parse(outcome.out)["digest"]) : "";
  }
  bool writes_nothing() const { return !std::filesystem::exists(m_folder / "out"); }

  TemporaryFolder m_folder;
};

using UnitOperationRun = OperationCli;
using PropertyOperationRun = OperationCli;
using FaultOperationRun = OperationCli;

TEST_F(UnitOperationRun, WritesAllFilesThatItsSceneAsksForAndNoOther) {
  const Outcome outcome = run(kOperation, {"--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  std::vector<std::string> told, found;
  const auto report = nlohmann::json::parse(outcome.out);
  for (const auto& file : report["outputs"]) told.push_back(file);
  for (const auto& entry : std::filesystem::directory_iterator(m_folder / "out")) {
    found.push_back(entry.path());
  }
  std::sort(told.begin(), told.end());
  std::sort(found.begin(), found.end());
  EXPECT_EQ(told, found);
  EXPECT_EQ(found.size(), 1u + 25u + 4u);  // end, pictures, log, score, two tracks
}

TEST_F(UnitOperationRun, ItsLogReplaysToTheSameScore) {
  ASSERT_EQ(run(kOperation).exit_code, 0);
  const OperationScore score = score_of_log(m_folder / "out/log.jsonl");
  EXPECT_EQ(json_text(to_value(score), 2) + "\n", text_of_file(m_folder / "out/score.json"));
  EXPECT_EQ(score.tasks.at(0).progress, 1);
  const Outcome told = run_supple({"replay", m_folder / "out/log.jsonl", "--json"});
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_EQ(told.out, text_of_file(m_folder / "out/score.json"));
}

TEST_F(UnitOperationRun, TrianglesThatTurnOverAreToldInLogReportAndText) {
  // Forceps turn twice with the fold that they hold.
  std::string scene = kOperation;
  for (const auto& [from, to] : {std::pair("nodes = 60", "nodes = 1500"),
                                 {"kind = \"needle\"", "kind = \"forceps\""},
                                 {"hand = { tremor = 0.05, seed = 3 }\n", ""},
                                 {"tip = [1, 0, -9] }", "tip = [1, 0, -9], opening = 20 }"},
                                 {"{ time = 1, tip = [-1, 0, -10.9] }",
                                  "{ time = 0.3, tip = [0, 0, -10.9], opening = 20 },"
                                  "{ time = 0.5, tip = [0, 0, -10.9] },"
                                  "{ time = 1, tip = [0.3, 0, -10.7], roll = 720 }"},
                                 {"image = \"end.png\"\nvideo = \"all_%02d.png\"\n", ""}}) {
    scene = replaced(scene, from, to);
  }
  const Outcome told = run(scene, {"--json"});
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const auto membrane = nlohmann::json::parse(told.out)["membranes"]["membrane"];
  OperationLogReader log(m_folder / "out/log.jsonl");
  int most = 0, last = 0;
  while (const auto step = log.next()) {
    last = step->membranes.at(0).inverted;
    most = std::max(most, last);
  }
  EXPECT_GT(most, 0);
  EXPECT_EQ(membrane["most_inverted_triangles"], most);
  EXPECT_EQ(membrane["inverted_triangles"], last);
  EXPECT_GT(membrane["longest_stretch"], 1);
  EXPECT_NE(run(scene, {"--force"})
                .out.find("membrane     " + std::to_string(most) + " of its triangles faced back"),
            std::string::npos);
}

TEST_F(FaultOperationRun, ALogThatIsCutOffTellsNoScore) {
  ASSERT_EQ(run(kOperation).exit_code, 0);
  const std::string whole = text_of_file(m_folder / "out/log.jsonl");
  write_text(m_folder / "cut.jsonl", whole.substr(0, whole.size() / 2));
  const Outcome told = run_supple({"replay", m_folder / "cut.jsonl"});
  EXPECT_EQ(told.exit_code, 3);
  EXPECT_EQ(std::count(told.err.begin(), told.err.end(), '\n'), 1) << told.err;
  EXPECT_TRUE(told.out.empty()) << told.out;
}

TEST_F(UnitOperationRun, ADryRunTellsStepsAndFilesAndWritesNothing) {
  const Outcome outcome = run(kOperation, {"--dry-run"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out.find("50 steps of 0.02 s\n"), 0u) << outcome.out;
  EXPECT_NE(outcome.out.find("out/log.jsonl"), std::string::npos) << outcome.out;
  EXPECT_TRUE(writes_nothing());
}

TEST_F(UnitOperationRun, AReplayTellsTimesOfAllStepsAndHowNearPicturesAreToSettledOnes) {
  const auto before = m_folder.entries();
  const Outcome outcome =
      supple_of("replay", replaced(kOperation, "[[view]]", "[[view]]\nstereo = \"side_by_side\""),
                {"--duration", "0.2", "--size", "64,48", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto report = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(report["steps"], 10);
  EXPECT_TRUE(report["pairs"]);
  EXPECT_GT(report["pictures_per_s"], 0);
  EXPECT_GT(report["settled_ssim"], 0.3);
  EXPECT_LT(report["settled_ssim"], 1);
  EXPECT_TRUE(report["times"].contains("picture"));
  EXPECT_EQ(m_folder.entries().size(), before.size() + 1);  // the scene
}

TEST_F(PropertyOperationRun, AnyNumberOfThreadsAndAReplayLeadToTheSameState) {
  const std::string one = digest_of(run(kOperation, {"--json", "--threads", "1"}));
  EXPECT_EQ(digest_of(run(kOperation, {"--json", "--threads", "2", "--force"})), one);
  EXPECT_EQ(digest_of(supple_of("replay", kOperation, {"--json", "--check", one})), one);
}

TEST_F(PropertyOperationRun, TracksThatItWritesLeadToTheSameState) {
  const std::string made = digest_of(run(kOperation, {"--json"}));
  std::string scene = kOperation;
  const std::size_t hand = scene.find("hand ="), end = scene.find("]\n\n", hand);
  scene.replace(hand, end + 1 - hand, "track = \"out/track_needle.csv\"");
  const std::size_t way = scene.find("way ="), last = scene.find('\n', way);
  scene.replace(way, last - way, "track = \"out/track_lamp.csv\"");
  EXPECT_EQ(digest_of(supple_of("replay", scene, {"--json"})), made);
}

TEST_F(FaultOperationRun, AnotherStateThanTheOneToCheckFails) {
  const std::string wrong(64, '0');
  const Outcome outcome = supple_of("replay", kOperation, {"--duration", "0.1", "--check", wrong});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("not " + wrong), std::string::npos) << outcome.err;
}

TEST_F(FaultOperationRun, CtrlCLeavesNoFile) {
  RUN_WHEN_SANITIZED();
  const std::string scene = replaced(kOperation, "duration = 1\n", "duration = 10000\n");
  for (const double seconds : {0.1, 0.5, 1.5}) {
    RunOptions options;
    options.interrupt_at_file = m_folder / "out";
    options.interrupt_after_s = seconds;
    const Outcome outcome = run(scene, {}, options);
    EXPECT_EQ(outcome.exit_code, 128 + SIGINT) << outcome.err;
    EXPECT_TRUE(writes_nothing());
  }
}

TEST_F(FaultOperationRun, ADiskThatIsFullAtTheLastFileLeavesNone) {
  // The picture of the end has the most bytes, and is written when all else is complete.
  std::string scene = replaced(kOperation, "duration = 1\n", "duration = 0.1\n");
  scene = replaced(scene, "size = [48, 36]", "size = [320, 240]");
  scene = replaced(scene, "video = \"all_%02d.png\"\n", "");
  RunOptions options;
  options.max_file_bytes = 12000;
  const Outcome outcome = run(scene, {}, options);
  EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
  EXPECT_NE(outcome.err.find("end.png"), std::string::npos) << outcome.err;
  EXPECT_TRUE(writes_nothing());
}

TEST_F(FaultOperationRun, OutputsThatAreThereAreKept) {
  ASSERT_EQ(run(kOperation).exit_code, 0);
  const std::string before = text_of_file(m_folder / "out/log.jsonl");
  const Outcome outcome = run(replaced(kOperation, "duration = 1\n", "duration = 0.5\n"));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("--force"), std::string::npos) << outcome.err;
  EXPECT_EQ(text_of_file(m_folder / "out/log.jsonl"), before);
}

TEST_F(FaultOperationRun, WrongScenesAreRefusedInOneLineThatSaysWhatToDo) {
  RUN_WHEN_SANITIZED();
  write_text(m_folder / "few.csv", "time_s,tip_x,tip_y,tip_z\n0,0,0,-9\n");
  const std::string way = "way = [{ time = 0, tip = [-3, -1, -2], active = 1 }]";
  const struct {
    const char* from;
    std::string to;
    std::vector<std::string> told;
  } cases[] = {
      {"duration = 1", "duratoin = 1", {"scene.toml:2", "duratoin", "duration"}},
      {"kind = \"needle\"", "kind = \"nedle\"", {"kind", "nedle", "needle"}},
      {"{ time = 1, tip", "{ time = 0, tip", {"scene.toml:19", "time", "a time after 0"}},
      {"\"temporal\"\nhand", "\"tempral\"\nhand", {"incision", "tempral", "temporal, nasal"}},
      {way.c_str(), "track = \"few.csv\"", {"few.csv:1", "no column axis_x"}},
      {way.c_str(), "track = \"none.csv\"", {"none.csv", "no such file"}},
      {way.c_str(), "", {"track", "a way"}},
      {"tip = [1, 0, -9]", "tip = [1, 0, -12]", {"scene.toml", "needle", "within retina"}},
      {"radius = 2,", "radius = -2,", {"radius", "-2", "positive"}},
      {"size = [48, 36]", "size = [48]", {"size", "two"}},
      {"track_%s.csv", "track.csv", {"tracks", "%s"}},
      {"log.jsonl", "log.txt", {"log.txt", ".jsonl"}},
      {"instrument = \"needle\"", "instrument = \"nedle\"", {"instrument", "nedle"}},
      {"kind = \"needle\"", "kind = \"parts\"", {"kind", "no parts", "parts = [{"}},
      {"kind = \"needle\"", "kind = \"needle\"\nlamp = {}", {"lamp", "parts"}},
  };
  for (const auto& [from, to, told] : cases) {
    const Outcome outcome = run(replaced(kOperation, from, to));
    EXPECT_EQ(outcome.exit_code, 3) << to << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    for (const std::string& part : told) {
      EXPECT_NE(outcome.err.find(part), std::string::npos) << part << " in " << outcome.err;
    }
    EXPECT_TRUE(writes_nothing());
  }
}

TEST_F(FaultOperationRun, OptionsThatOperationsLackAreRefused) {
  const std::vector<std::vector<std::string>> of_run = {{"--method", "relax-26:64"},
                                                        {"--resume"},
                                                        {"--frames", "1:2"},
                                                        {"--drawing", "draw-newton:0.5"},
                                                        {"--state", "a.vdb"},
                                                        {"--accuracy", "0.1"},
                                                        {"--plan"},
                                                        {"--budget", "1s"}};
  const std::vector<std::vector<std::string>> of_replay = {
      {"--speed", "1"}, {"--budget", "20"},   {"--fps", "10"},      {"--film", "a.mp4"},
      {"--ssim"},       {"--state", "a.vdb"}, {"--scene", "a.toml"}};
  for (const auto& [command, all] : {std::pair("run", of_run), {"replay", of_replay}}) {
    for (const std::vector<std::string>& option : all) {
      const Outcome outcome = supple_of(command, kOperation, option);
      EXPECT_EQ(outcome.exit_code, 2) << option[0] << outcome.err;
      EXPECT_NE(outcome.err.find(option[0]), std::string::npos) << outcome.err;
    }
  }
}

}  // namespace
