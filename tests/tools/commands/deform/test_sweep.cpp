// supple sweep: rows in order, errors as rows, going on after kill -9 and Ctrl-C, journals that are
// none, diagrams and pictures.
#include <algorithm>
#include <csignal>
#include <fstream>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/base/csv.h"
#include "volumes/base/json.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr const char* kScene = R"([volume]
path = "ball.nhdr"
[material]
table = "soft.toml"
[[step]]
model = "fem"
fix = [[0, 0, 0, 23, 23, 4]]
[step.fem]
swellings = [{ pressure_kpa = 1.0, grab_box = [0, 0, 5, 23, 23, 23] }]
[[view]]
image = "ball.png"
size = [32, 32]
)";

class Sweeps : public testing::Test {
 protected:
  Sweeps() {
    write_ball(m_folder, "ball", 24);
    write_soft_material(m_folder / "soft.toml");
    std::ofstream(m_folder / "soft.toml", std::ios::app) << "stiffness = 6\npoisson = 0.45\n";
    m_folder.write("s.toml", kScene);
  }
  Outcome sweep(const std::string& table, std::vector<std::string> more,
                const RunOptions& options = {}) const {
    std::vector<std::string> words = {"sweep", m_folder / "s.toml"};
    if (!table.empty()) more.insert(more.end(), {"-o", m_folder / table});
    words.insert(words.end(), more.begin(), more.end());
    return run_supple(words, options);
  }
  std::vector<std::vector<std::string>> rows_of(const std::string& table) const {
    std::vector<std::vector<std::string>> rows;
    const std::string text = read_text(m_folder / table);
    for (std::size_t at = 0; at < text.size();) rows.push_back(take_csv_line(text, at));
    return rows;
  }
  /// The line of an error without the folder.
  static std::string error_of(const Outcome& outcome) {
    const std::size_t at = outcome.err.find("supple: error: ");
    std::string line = at == std::string::npos ? "" : outcome.err.substr(at + 15);
    line = line.substr(0, line.find('\n'));
    for (std::size_t slash; (slash = line.find("/tmp")) != std::string::npos;) {
      line.erase(slash, line.find('/', line.find('/', slash + 1) + 1) + 1 - slash);
    }
    return line;
  }
  bool has(const std::string& name) const { return std::filesystem::exists(m_folder / name); }

  const std::vector<std::string> m_grid = {"--vary", "material.poisson=0.3,0.45", "--vary",
                                           "step.fem.swellings.pressure_kpa=1,2,4"};
  const TemporaryFolder m_folder;
};

using UnitSweep = Sweeps;
using FaultSweep = Sweeps;

TEST_F(UnitSweep, RowsAreTheProductInOrderAndResultsThoseOfARun) {
  RUN_WHEN_SANITIZED();
  const Outcome outcome = sweep("t.csv", m_grid);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto rows = rows_of("t.csv");
  ASSERT_EQ(rows.size(), 7u);
  EXPECT_EQ(rows[0], (std::vector<std::string>{"material.poisson",
                                               "step.fem.swellings.pressure_kpa", "smallest_det_f",
                                               "volume_change_ml", "anchor_force_n", "error"}));
  for (std::size_t n = 1; n < rows.size(); ++n) {
    EXPECT_EQ(rows[n][0], n < 4 ? "0.3" : "0.45");
    EXPECT_EQ(rows[n][1], (std::vector<std::string>{"1", "2", "4"})[(n - 1) % 3]);
    EXPECT_EQ(rows[n].back(), "");
  }
  // Linear theory: twice the pressure, twice the volume; softer against volume, more of it.
  EXPECT_NEAR(std::stod(rows[2][3]), 2 * std::stod(rows[1][3]), 1e-6);
  EXPECT_GT(std::stod(rows[1][3]), 1.5 * std::stod(rows[4][3]));
  // The last case is what `supple run` makes of the scene.
  std::string scene = kScene;
  scene.replace(scene.find("pressure_kpa = 1.0"), 18, "pressure_kpa = 4.0");
  m_folder.write("s.toml", scene);
  const Outcome run = run_supple({"run", m_folder / "s.toml", "-o", m_folder / "out", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Value report = parse_json(run.out);
  EXPECT_EQ(std::stod(rows[6][3]), report["steps"][0]["fem"]["volume_change_ml"].number());
  EXPECT_GT(report["total_s"].number(), 0);
}

TEST_F(UnitSweep, OtherColumnsAndMoreValuesNeedNoOtherRun) {
  ASSERT_EQ(sweep("t.csv", {"--vary", "material.poisson=0.3,0.4"}).exit_code, 0);
  const std::string before = read_text(m_folder / "t.csv.cases");
  const Outcome again =
      sweep("t.csv", {"--vary", "material.poisson=0.4,0.3,0.45", "--collect",
                      "swollen (ml)=volume_change_ml", "--collect", "steps[0].model", "--force"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NE(again.err.find("2 of 3 cases are in"), std::string::npos) << again.err;
  const auto rows = rows_of("t.csv");
  EXPECT_EQ(rows[0], (std::vector<std::string>{"material.poisson", "swollen (ml)", "steps[0].model",
                                               "error"}));
  EXPECT_EQ(rows[3][0], "0.45");
  EXPECT_EQ(rows[3][2], "fem");
  EXPECT_EQ(read_text(m_folder / "t.csv.cases").rfind(before, 0), 0u) << "one case was added";
  const Outcome list = sweep("", {"--list"});
  EXPECT_NE(list.out.find("* steps[0].fem.volume_change_ml"), std::string::npos) << list.out;
  const Outcome wrong = sweep("u.csv", {"--collect", "volume_chang_ml"});
  EXPECT_EQ(wrong.exit_code, 3);
  EXPECT_FALSE(has("u.csv"));
  EXPECT_TRUE(has("u.csv.cases")) << "with the right name nothing is run again";
}

TEST_F(FaultSweep, WrongKeysAndValuesAreRefusedBeforeAnythingRuns) {
  const auto error = [&](std::vector<std::string> words) {
    const Outcome outcome = sweep("t.csv", std::move(words));
    EXPECT_FALSE(has("t.csv") || has("t.csv.cases")) << outcome.err;
    return std::to_string(outcome.exit_code) + " " + error_of(outcome);
  };
  EXPECT_EQ(error({"--vary", "step.fem.swelings.pressure_kpa=1"}),
            "3 s.toml: step[1].fem.swelings: found an unknown key, expected a known one: did you "
            "mean 'swellings'?");
  EXPECT_EQ(error({"--vary", "material.poisson=0.6,0.3"}).substr(0, 60),
            "3 s.toml: poisson key point 1: found [0, 0.6], expected pois");
  EXPECT_EQ(error({"--vary", "step[2].model=fem"}),
            "3 s.toml: step[2]: found 1 item, expected [1], the only one");
  EXPECT_EQ(error({"--vary", "step.fix=[[0, 0, 99]]"}).substr(0, 2), "3 ");
  EXPECT_EQ(error({"--vary", "material.poisson"}),
            "2 --vary: found 'material.poisson', expected KEY=A,B,C");
  EXPECT_EQ(error({"--cases", m_folder / "none.csv"}),
            "3 none.csv: found no such file, expected a readable file");
  EXPECT_EQ(error({"--collect", "=x"}), "2 --collect: found '=x', expected NAME=PATH or PATH");
  EXPECT_EQ(error({"--x", "a"}).substr(0, 2), "2 ");
  EXPECT_EQ(error({"--plot", m_folder / "t.svg"}),
            "2 --plot: found one case, expected --vary with several values, or --x");
}

TEST_F(FaultSweep, ACaseThatFailsIsARowAndTheOthersGoOn) {
  RUN_WHEN_SANITIZED();
  const Outcome outcome =
      sweep("t.csv", {"--vary", "material.poisson=0.3,0.6", "--vary",
                      "step.fix=[[0, 0, 0, 23, 23, 4]],[[0, 0, 99]],[[12, 12, 4]]"});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("case 4 (material.poisson = 0.6, step.fix = [[0, 0, 0, 23, 23, 4]]) "
                             "will not be run"),
            std::string::npos)
      << outcome.err;
  EXPECT_NE(error_of(outcome).find("4 of 6 cases failed: see the column error of t.csv"),
            std::string::npos)
      << outcome.err;
  const auto rows = rows_of("t.csv");
  ASSERT_EQ(rows.size(), 7u);
  EXPECT_EQ(rows[1].back(), "");
  EXPECT_NE(rows[2].back().find("0,0,99"), std::string::npos) << rows[2].back();
  EXPECT_EQ(rows[2][3], "");
  EXPECT_EQ(rows[3].back(), "");
  EXPECT_NE(rows[6].back().find("expected poisson from 0 to 0.4999"), std::string::npos);
}

TEST_F(FaultSweep, KilledItGoesOnToTheSameBytes) {
  RUN_WHEN_SANITIZED();
  ASSERT_EQ(sweep("whole.csv", m_grid).exit_code, 0);
  int killed = 0, in_journal = 0;
  for (const double seconds : {0.0, 0.1, 0.3, 0.5}) {
    const std::string table = "killed" + std::to_string(int(10 * seconds)) + ".csv";
    RunOptions options;
    options.interrupt_at_file = m_folder / (table + ".cases");
    options.interrupt_after_s = seconds;
    options.interrupt_by = SIGKILL;
    const Outcome first = sweep(table, m_grid, options);
    if (first.exit_code != 0) {
      EXPECT_EQ(first.exit_code, 128 + SIGKILL) << first.err;
      EXPECT_FALSE(has(table));
      ++killed;
      const Outcome second = sweep(table, m_grid);
      ASSERT_EQ(second.exit_code, 0) << second.err;
      if (second.err.find("are in") != std::string::npos ||
          second.err.find("is in") != std::string::npos) {
        ++in_journal;
      }
    }
    EXPECT_EQ(read_text(m_folder / table), read_text(m_folder / "whole.csv"));
  }
  EXPECT_GT(killed, 0);
  EXPECT_GT(in_journal, 0);
}

TEST_F(FaultSweep, CtrlCLeavesFinishedCasesAndSaysHowToGoOn) {
  RunOptions options;
  options.interrupt_at_file = m_folder / "t.csv.cases";
  options.interrupt_after_s = 0;
  std::vector<std::string> words = m_grid;
  words.insert(words.end(), {"--vary", "step.fem.swellings.grab_box[3]=20,21,22,23"});
  const Outcome outcome = sweep("t.csv", words, options);
  EXPECT_EQ(outcome.exit_code, 128 + SIGINT) << outcome.err;
  EXPECT_FALSE(has("t.csv"));
  EXPECT_TRUE(has("t.csv.cases"));
  EXPECT_NE(outcome.err.find("t.csv.cases; the same command goes on with the others"),
            std::string::npos)
      << outcome.err;
}

TEST_F(FaultSweep, AJournalIsReadAsFarAsItIsWholeAndNoOtherFileIsOne) {
  const std::vector<std::string> words = {"--vary", "material.poisson=0.3,0.4"};
  ASSERT_EQ(sweep("t.csv", words).exit_code, 0);
  const std::string table = read_text(m_folder / "t.csv");
  const std::string journal = read_text(m_folder / "t.csv.cases");
  const auto again_with = [&](const std::string& text, std::vector<std::string> more = {}) {
    m_folder.write("t.csv.cases", text);
    more.insert(more.end(), {"--force", "--vary", "material.poisson=0.3,0.4"});
    const Outcome outcome = sweep("t.csv", more);
    if (outcome.exit_code == 0) {
      EXPECT_EQ(read_text(m_folder / "t.csv"), table);
    }
    return std::to_string(outcome.exit_code) + " " + error_of(outcome);
  };
  // Cut off within its last line, as by a full disk: that case is run again.
  EXPECT_EQ(again_with(journal.substr(0, journal.size() - 100)), "0 ");
  const std::string mended = read_text(m_folder / "t.csv.cases");
  EXPECT_EQ(std::count(mended.begin(), mended.end(), '\n'), 3);
  EXPECT_EQ(again_with(mended), "0 ") << "nothing is left of the line that was cut off";
  EXPECT_EQ(again_with(""), "0 ");
  // Cut off within its first line, also by another version or for another scene: no case was in it.
  const std::string head = journal.substr(0, journal.find('\n'));
  for (const std::size_t length : {std::size_t(1), std::size_t(20), head.size()}) {
    EXPECT_EQ(again_with(head.substr(0, length)), "0 ");
  }
  EXPECT_EQ(again_with(R"({"file":"cases of supple sweep","program":"supple 0.)", {"--anew"}),
            "0 ");
  const std::string second = journal.substr(journal.find('\n') + 1);
  EXPECT_EQ(again_with(journal + "junk\n" + second),
            "3 t.csv.cases:4: found no case of a sweep, expected one, or --anew to run all cases "
            "again");
  EXPECT_EQ(again_with(journal + "junk\n", {"--anew"}), "0 ");
  for (const char* other : {"my notes\n", "my notes", "[1]\n", "{}\n"}) {
    EXPECT_EQ(again_with(other, {"--anew"}),
              "3 t.csv.cases:1: found another file, expected the cases of a sweep, or another name "
              "for the table");
    EXPECT_EQ(read_text(m_folder / "t.csv.cases"), other);
  }
  m_folder.write("s.toml", std::string(kScene) + "[[step]]\nrelease = true\nrelax = {}\n");
  const std::string changed =
      "3 t.csv.cases:1: found cases of another scene, or of files of it that have changed, "
      "expected those of this one; --anew runs all cases again";
  EXPECT_EQ(again_with(journal), changed);
  m_folder.write("s.toml", kScene);
  EXPECT_EQ(again_with(journal), "0 ");
  write_ball(m_folder, "ball", 25);  // the header and its values
  EXPECT_EQ(again_with(journal), changed);
}

TEST_F(UnitSweep, ADiagramHasACurvePerValueOfTheOtherKeys) {
  std::vector<std::string> words = m_grid;
  words.insert(words.end(), {"--plot", m_folder / "t.svg", "--x", "pressure_kpa", "--y",
                             "volume_change_ml", "--pictures", m_folder / "drawn"});
  const Outcome outcome = sweep("t.csv", words);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string svg = read_text(m_folder / "t.svg");
  for (const char* text :
       {">pressure (kPa)<", ">volume change (ml)<", ">poisson<", ">0.3<", ">0.45<"}) {
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  }
  EXPECT_TRUE(runs_python(
      "-c \"import sys, xml.etree.ElementTree as t; r = t.parse(sys.argv[1]).getroot(); "
      "s = '{http://www.w3.org/2000/svg}'; "
      "assert len(r.findall('.//' + s + 'circle')) == 6 + 2\" " +
      (m_folder / "t.svg")));
  EXPECT_TRUE(has("drawn/poisson_0.3_pressure_kpa_1_ball.png"));
  EXPECT_TRUE(has("drawn/poisson_0.45_pressure_kpa_4_ball.png"));
  // A picture that is gone is drawn again.
  std::filesystem::remove(m_folder / "drawn/poisson_0.3_pressure_kpa_4_ball.png");
  words.emplace_back("--force");
  EXPECT_NE(sweep("t.csv", words).err.find("5 of 6 cases are in"), std::string::npos);
  EXPECT_TRUE(has("drawn/poisson_0.3_pressure_kpa_4_ball.png"));
}

TEST_F(UnitSweep, PicturesKeepTheirNamesWhenValuesAreAdded) {
  ASSERT_EQ(sweep("t.csv", {"--vary", "material.poisson=0.3"}).exit_code, 0);
  const Outcome drawn = sweep(
      "t.csv", {"--vary", "material.poisson=0.3", "--pictures", m_folder / "drawn", "--force"});
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_TRUE(has("drawn/poisson_0.3_ball.png"));
  const Outcome more = sweep(
      "t.csv", {"--vary", "material.poisson=0.2,0.3", "--pictures", m_folder / "drawn", "--force"});
  EXPECT_NE(more.err.find("1 of 2 cases is in"), std::string::npos) << more.err;
  // Names of values that no file can have, or that are long, are told apart.
  const Outcome odd =
      sweep("u.csv", {"--vary", "step.fix=[[12, 12, 4]],[[12, 12], [4]],[[12, 12, 5]]",
                      "--pictures", m_folder / "odd"});
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(m_folder / "odd")) {
    names.insert(entry.path().filename().string().substr(0, 12));
  }
  EXPECT_EQ(names, (std::set<std::string>{"fix_12_12_4_", "fix_12_12_5_"})) << odd.err;
}

TEST_F(FaultSweep, TheTableIsThereWhereTheDiagramFails) {
  const Outcome outcome = sweep("t.csv", {"--vary", "material.poisson=0,0.3", "--plot",
                                          m_folder / "t.svg", "--x", "poisson", "--log", "x"});
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_TRUE(has("t.csv")) << outcome.err;
  EXPECT_FALSE(has("t.svg"));
}

TEST_F(FaultSweep, AFullDiskEndsTheSweepAndAListDrawsNothing) {
  const Outcome list = sweep("", {"--list", "--pictures", m_folder / "listed"});
  EXPECT_EQ(list.exit_code, 0) << list.err;
  EXPECT_FALSE(has("listed"));
  EXPECT_EQ(sweep("", {"--list", "--vary", "step.fix=[[0, 0, 99]]"}).exit_code, 3);
  RunOptions full;
  full.max_file_bytes = 100;
  const Outcome outcome = sweep(
      "t.csv", {"--vary", "material.poisson=0.3,0.4", "--pictures", m_folder / "drawn"}, full);
  EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
  EXPECT_FALSE(has("t.csv"));
}

TEST_F(FaultSweep, NoInputIsOverwritten) {
  m_folder.write("points.csv", "x,y,z\n12,12,24\n");
  std::string scene = kScene;
  scene.replace(scene.find("[step.fem]"), 0, "fix_points = \"points.csv\"\n");
  m_folder.write("s.toml", scene);
  const Outcome outcome = sweep("points.csv", {"--vary", "material.poisson=0.3", "--force"});
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_EQ(read_text(m_folder / "points.csv"), "x,y,z\n12,12,24\n");
}

}  // namespace
