// Time against error: rows and their file, fronts, values between points, and the command on a
// ball.
#include <filesystem>
#include <fstream>
#include <random>
#include <regex>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/errors.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "tools/lab/tradeoff/trade_curves.h"
#include "tools/scene/choice/chosen_method.h"
#include "tools/scene/choice/method_choice.h"
#include "tools/scene/choice/run_phases.h"
#include "tools/scene/choice/trade_row.h"
#include "tools/scene/file/step_method.h"
#include "volumes/io/load/load.h"

using namespace supple;
using namespace supple::test;
using namespace supple::tools;

namespace {

TradeRow row_of(const std::string& method, double knob, double time_s, double error_mm) {
  TradeRow row;
  row.scene = "a.toml";
  row.inputs = "0123456789ab";
  row.method = method;
  row.knob = knob;
  row.status = "ok";
  row.runs = 3;
  row.solve_s = {time_s / 1.5, time_s, time_s * 1.5};
  row.p95_mm = error_mm;
  return row;
}

std::vector<std::size_t> rows_of(const std::vector<TradePoint>& points) {
  std::vector<std::size_t> rows;
  for (const TradePoint& point : points) rows.push_back(point.row);
  return rows;
}

TEST(UnitTradeCurves, TheFrontIsWhatNoOtherPointBeats) {
  RUN_WHEN_SANITIZED();
  const std::vector<TradePoint> points = {{1, 5, 0}, {2, 5, 1},   {3, 1, 2}, {3, 2, 3},
                                          {2, 4, 4}, {0.5, 9, 5}, {9, 1, 6}};
  EXPECT_EQ(rows_of(pareto_front(points)), (std::vector<std::size_t>{5, 0, 4, 2}));
  EXPECT_TRUE(pareto_front({}).empty());
}

TEST(UnitTradeCurves, BetweenPointsALineInLogarithmsIsRead) {
  RUN_WHEN_SANITIZED();
  const std::vector<TradePoint> points = {{0.1, 10, 0}, {10, 0.1, 1}};
  const auto time = time_to_error(points, 1, 1e-6);
  ASSERT_TRUE(time);
  EXPECT_NEAR(time->value, 1, 1e-12);
  EXPECT_EQ(time->row_a, 0u);
  EXPECT_EQ(time->row_b, 1u);
  const auto error = error_within_time(points, 1, 1e-6);
  ASSERT_TRUE(error);
  EXPECT_NEAR(error->value, 1, 1e-12);
}

TEST(UnitTradeCurves, BeyondItsPointsACurvePromisesNothing) {
  RUN_WHEN_SANITIZED();
  const std::vector<TradePoint> points = {{0.1, 10, 0}, {10, 0.1, 1}};
  EXPECT_FALSE(time_to_error(points, 0.05, 1e-6));
  EXPECT_FALSE(error_within_time(points, 0.05, 1e-6));
  EXPECT_EQ(time_to_error(points, 20, 1e-6)->value, 0.1);
  EXPECT_EQ(error_within_time(points, 99, 1e-6)->value, 0.1);
  EXPECT_FALSE(time_to_error({}, 1, 1e-6));
}

TEST(UnitTradeCurves, APointThatItsOwnCurveBeatsBendsNoLine) {
  RUN_WHEN_SANITIZED();
  const std::vector<TradePoint> points = {{0.1, 10, 0}, {1, 50, 1}, {10, 0.1, 2}};
  EXPECT_NEAR(time_to_error(points, 1, 1e-6)->value, 1, 1e-12);
}

TEST(UnitTradeCurves, NoErrorBelowTheFloorIsRead) {
  RUN_WHEN_SANITIZED();
  const std::vector<TradePoint> points = {{1, 1, 0}, {10, 0, 1}};
  EXPECT_EQ(error_within_time(points, 20, 1e-3)->value, 1e-3);
}

TEST(UnitTradeRow, TheMedianOfAnEvenNumberIsTheMeanOfTheMiddleTwo) {
  RUN_WHEN_SANITIZED();
  EXPECT_EQ(spread_of({3, 1, 2, 9}).median, 2.5);
  EXPECT_EQ(spread_of({3, 1, 9}).median, 3);
  EXPECT_EQ(spread_of({3, 1, 9}).least, 1);
  EXPECT_EQ(spread_of({3, 1, 9}).most, 9);
}

TEST(UnitTradeRow, RowsComeBackFromTheirFileToTheBit) {
  RUN_WHEN_SANITIZED();
  TradeRow row = row_of("relax-26", 64, 1.0 / 3, 2e-300);
  row.scene = "a \"quoted\", name.toml";
  row.reason = "two\nlines";
  row.command = "supple run 'a b.toml' -o x";
  row.moved = 123456789012;
  const std::string text = to_csv({row, row_of("fem", 1e-10, 2, 0)});
  const std::vector<TradeRow> rows = rows_from_csv(text, "runs.csv");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(to_csv(rows), text);
  EXPECT_EQ(rows[0].scene, row.scene);
  EXPECT_EQ(rows[0].reason, row.reason);
  EXPECT_EQ(rows[0].solve_s.median, row.solve_s.median);
  EXPECT_EQ(rows[0].p95_mm, row.p95_mm);
  EXPECT_EQ(rows[0].moved, row.moved);
  EXPECT_EQ(rows[1].name(), "fem:1e-10");
}

TEST(UnitTradeRow, AFileOfOtherColumnsIsRefusedWithItsLine) {
  RUN_WHEN_SANITIZED();
  const std::string text = to_csv({row_of("fem", 1, 2, 0)});
  const auto problem_of = [](const std::string& csv) {
    return input_error([&] { rows_from_csv(csv, "runs.csv"); });
  };
  EXPECT_NE(problem_of("x" + text).find("runs.csv:1"), std::string::npos);
  const std::string cut = problem_of(text.substr(0, text.find('\n') + 40));
  EXPECT_NE(cut.find("runs.csv:2"), std::string::npos) << cut;
  EXPECT_NE(cut.find("columns of this version"), std::string::npos) << cut;
  std::string damaged = text;
  damaged.replace(damaged.find("ab,fem,1") + 7, 1, "?");
  EXPECT_NE(problem_of(damaged).find("knob"), std::string::npos);
}

TEST(UnitTradeTables, RowsWhoseTimesOverlapAreToldApartByTheirErrors) {
  RUN_WHEN_SANITIZED();
  std::vector<TradeRow> rows = {row_of("fem", 1e-10, 9, 0), row_of("ecm", 6, 1, 1),
                                row_of("ecm", 18, 1.2, 1.01), row_of("ecm", 26, 1.2, 1.5),
                                row_of("ecm", 26, 99, 1)};
  TradeRow failed = row_of("springs", 2, 0, 0);
  failed.status = "failed";
  rows.push_back(failed);
  const SceneCurves curves =
      curves_of(rows, "a.toml", false, 1e-6, [](const std::string& method) { return method; });
  EXPECT_EQ(curves.alike, (std::vector<std::pair<std::size_t, std::size_t>>{{1, 2}}));
  EXPECT_EQ(curves.alike_text(2), "not distinguishable from row 3");
  EXPECT_EQ(rows_of(curves.front), (std::vector<std::size_t>{1}));
  ASSERT_EQ(curves.methods.size(), 2u);
  EXPECT_EQ(curves.methods[1].missed, (std::vector<std::size_t>{5}));
}

TEST(UnitMethodChoice, ItIsTheBestThatEveryLoadOfTheTableAllows) {
  std::vector<TradeRow> rows = {row_of("ecm", 6, 0.1, 2), row_of("relax-6", 16, 0.4, 0.9),
                                row_of("fem", 0.1, 3, 0.01), row_of("springs", 2, 1, 0.1)};
  for (TradeRow row : std::vector<TradeRow>(rows)) {
    row.scene = "b.toml";
    if (row.method == "relax-6") row.solve_s.median = 0.5;
    if (row.method == "ecm") row.p95_mm = 3;
    if (row.method == "fem") row.p95_mm = 0.002;
    if (row.method == "springs") row.status = "failed";
    rows.push_back(row);
  }
  rows.push_back(row_of("relax-6", 64, 0.2, 0.001));  // of one load alone
  const std::vector<MethodChoice> choices = choices_of(rows);
  ASSERT_EQ(choices.size(), 3u);
  EXPECT_EQ(choices[0].error_mm, 3);
  EXPECT_EQ(most_exact_within(choices, 0.45)->method, "ecm:6");
  EXPECT_EQ(most_exact_within(choices, 0.5)->method, "relax-6:16");
  EXPECT_FALSE(most_exact_within(choices, 0.05));
  EXPECT_EQ(fastest_to(choices, 1)->method, "relax-6:16");
  EXPECT_EQ(fastest_to(choices, 0.5)->method, "fem:0.1");
  EXPECT_FALSE(fastest_to(choices, 0.005)) << "under one load alone";
  EXPECT_FALSE(fastest_to(choices, 0.001));
}

TEST(UnitMethodChoice, ALargerErrorNeverChoosesASlowerMethodNorALongerTimeALessExactOne) {
  std::mt19937 random(3);
  for (int table = 0; table < 50; ++table) {
    std::vector<MethodChoice> choices;
    for (int n = 0; n < 6; ++n) {
      choices.push_back({std::to_string(n), double(random() % 9 + 1), double(random() % 9 + 1)});
    }
    sort_by_time(choices);
    for (int most = 1; most < 9; ++most) {
      const auto by_error = fastest_to(choices, most), looser = fastest_to(choices, most + 1);
      EXPECT_TRUE(!by_error || looser->solve_s <= by_error->solve_s) << table << ' ' << most;
      const auto by_time = most_exact_within(choices, most);
      const auto longer = most_exact_within(choices, most + 1);
      EXPECT_TRUE(!by_time || longer->error_mm <= by_time->error_mm) << table << ' ' << most;
    }
  }
}

TEST(UnitMethodChoice, TimesAndLengthsHaveUnits) {
  EXPECT_DOUBLE_EQ(seconds_of("100ms", "budget"), 0.1);
  EXPECT_DOUBLE_EQ(seconds_of("1.5min", "budget"), 90);
  EXPECT_DOUBLE_EQ(millimetres_of("0.5mm", "error"), 0.5);
  for (const char* wrong : {"100", "ms", "-1s", "1h", "nans", ""}) {
    EXPECT_FALSE(input_error([&] { seconds_of(wrong, "budget"); }).empty()) << wrong;
  }
}

class UnitTradeoff : public ::testing::Test {
 protected:
  void SetUp() override {
    write_ball(m_folder, "ball", 10);
    write_soft_material(m_folder / "m.toml");
    write_text(m_folder / "scene.toml",
               "[volume]\npath = \"ball.nhdr\"\n[material]\ntable = \"m.toml\"\n[[step]]\n"
               "grab = [5, 8, 5]\nby = [0.0, 0.6, 0.0]\nfix = [[0, 0, 0, 9, 2, 9]]\n");
  }
  Outcome measure(const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {
        "tradeoff", m_folder / "scene.toml", "-o", m_folder / "out", "--runs", "1", "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_supple(arguments);
  }
  std::string csv() const { return read_text(m_folder / "out/runs.csv"); }
  std::vector<TradeRow> rows() const { return rows_from_csv(csv(), "runs.csv"); }

  TemporaryFolder m_folder;
};

TEST_F(UnitTradeoff, MorePassesAndFinerTolerancesDoNotWorsenTheError) {
  std::vector<std::string> methods;
  for (const char* name :
       {"ecm:6", "relax-6:1", "relax-6:16", "relax-6:256", "fem:0.1", "fem:1e-3", "fem:1e-8"}) {
    methods.insert(methods.end(), {"--method", name});
  }
  const Outcome outcome = measure(methods);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<TradeRow> all = rows();
  ASSERT_EQ(all.size(), 8u);
  EXPECT_EQ(all[0].name(), "fem:1e-10");
  EXPECT_EQ(all[0].max_mm, 0);
  EXPECT_GT(all[0].moved, 100);
  EXPECT_GT(all[1].p95_mm, 0.01);
  // Passes lower the energy of the links, which is not that of the reference: to within a tenth.
  for (std::size_t r = 3; r < 5; ++r) EXPECT_LE(all[r].p95_mm, 1.1 * all[r - 1].p95_mm) << r;
  EXPECT_LT(all[4].p95_mm, 0.8 * all[2].p95_mm);
  for (std::size_t r = 6; r < 8; ++r) EXPECT_LE(all[r].p95_mm, all[r - 1].p95_mm) << r;
  EXPECT_LT(all[7].p95_mm, 1e-4);
  for (std::size_t r = 2; r < 5; ++r) EXPECT_LE(all[r].energy_uj, all[r - 1].energy_uj) << r;
  const auto json = nlohmann::json::parse(read_text(m_folder / "out/tradeoff.json"));
  EXPECT_EQ(json["rows"].size(), all.size());
  EXPECT_NEAR(load_volume(m_folder / "out/runs/scene/ecm_6/error.nrrd").statistics.max,
              all[1].max_mm, 1e-6);
  const std::string page = read_text(m_folder / "out/index.html");
  EXPECT_NE(page.find("id=\"row-9\""), std::string::npos);
  EXPECT_EQ(page.find("http"), std::string::npos) << "the page asks for nothing";
}

TEST_F(UnitTradeoff, ElementsOfHalfAVoxelSayHowFarTheReferenceIsFromItsLimit) {
  ASSERT_EQ(measure({"--method", "fem-fine", "--method", "ecm:6"}).exit_code, 0);
  const std::vector<TradeRow> all = rows();
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[1].name(), "fem-fine:1");
  EXPECT_GT(all[1].p95_mm, 1e-3);
  EXPECT_LT(all[1].p95_mm, all[2].p95_mm);
  const auto scene = nlohmann::json::parse(read_text(m_folder / "out/tradeoff.json"))["scenes"][0];
  EXPECT_NEAR(scene["size_error_mm"], 2 * all[1].p95_mm, 1e-9);
  EXPECT_EQ(scene["solving"]["floor"], scene["size_error_mm"]);
  EXPECT_NE(read_text(m_folder / "out/index.html").find("Richardson"), std::string::npos);
  ASSERT_EQ(measure({"--method", "ecm:6"}).exit_code, 0);
  EXPECT_NE(read_text(m_folder / "out/index.html").find("smaller elements were not measured"),
            std::string::npos);
}

TEST_F(UnitTradeoff, ACallGoesOnWhereTheLastOneEnded) {
  ASSERT_EQ(measure({"--method", "ecm"}).exit_code, 0);
  const std::string whole = csv();
  const std::vector<TradeRow> before = rows();
  ASSERT_EQ(before.size(), 4u);
  // The last row is not there, as after a kill.
  write_text(m_folder / "out/runs.csv", to_csv({before[0], before[1], before[2]}));
  ASSERT_EQ(measure({"--method", "ecm"}).exit_code, 0);
  const std::vector<TradeRow> after = rows();
  ASSERT_EQ(after.size(), 4u);
  for (std::size_t r = 0; r < 3; ++r) EXPECT_EQ(to_csv({after[r]}), to_csv({before[r]})) << r;
  EXPECT_EQ(after[3].name(), before[3].name());
  EXPECT_EQ(after[3].p95_mm, before[3].p95_mm);
  EXPECT_NE(after[3].wall_s.median, before[3].wall_s.median) << "it was measured again";
}

TEST_F(UnitTradeoff, ARunTakesTheMethodOfARowAndWritesTheStateThatIsNamed) {
  ASSERT_EQ(measure({"--method", "relax-18:4"}).exit_code, 0);
  const TradeRow row = rows()[1];
  EXPECT_NE(row.command.find("--method relax-18:4"), std::string::npos);
  EXPECT_EQ(run_supple({"run", m_folder / "scene.toml", "--method", "relax-18:4", "--state",
                        "a.vdb", "-o", m_folder / "again", "--json"})
                .exit_code,
            0);
  EXPECT_TRUE(std::filesystem::exists(m_folder / "again/a.vdb"));
}

TEST_F(UnitTradeoff, ARunChoosesFromTheTableAndSaysWhat) {
  ASSERT_EQ(measure({"--method", "ecm:6", "--method", "fem:1e-8"}).exit_code, 0);
  const auto run = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {
        "run",     m_folder / "scene.toml",   "-o",    m_folder / "c",
        "--table", m_folder / "out/runs.csv", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_supple(arguments);
  };
  const Outcome exact = run({"--error", "0.001mm"});
  ASSERT_EQ(exact.exit_code, 0) << exact.err;
  const auto chosen = nlohmann::json::parse(exact.out)["chosen"];
  EXPECT_EQ(chosen["method"].get<std::string>().substr(0, 4), "fem:");
  EXPECT_GT(chosen["solve_s"], 0);
  const Outcome roomy = run({"--budget", "10min"});
  EXPECT_NE(roomy.err.find("chose fem:"), std::string::npos) << roomy.err;
  EXPECT_EQ(run({"--budget", "0.001ms"}).exit_code, 3);
  const Outcome alone = run({});
  EXPECT_EQ(alone.exit_code, 3);
  EXPECT_NE(alone.err.find("--budget or --error beside it"), std::string::npos) << alone.err;
  std::filesystem::remove(m_folder / "out/runs.csv");
  const Outcome missing = run({"--budget", "10min"});
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_NE(missing.err.find("found no such file"), std::string::npos) << missing.err;
}

TEST_F(UnitTradeoff, WithoutATableARunChoosesFromWhatIsShipped) {
  ASSERT_GE(shipped_methods().size(), 5u);
  for (const std::string& method : shipped_methods()) {
    EXPECT_NO_THROW(parse_method(method));
    EXPECT_DOUBLE_EQ(shipped_error_mm(method, 10), 5 * shipped_error_mm(method, 2));
  }
  const auto run = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {
        "run", m_folder / "scene.toml", "-o", m_folder / "c", "--json", "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_supple(arguments);
  };
  const Outcome exact = run({"--error", "0.05mm"});
  ASSERT_EQ(exact.exit_code, 0) << exact.err;
  EXPECT_NE(exact.err.find("chose fem:0.1 by plans of the scene"), std::string::npos) << exact.err;
  const auto chosen = nlohmann::json::parse(exact.out)["chosen"];
  EXPECT_LE(chosen["expected_error_p95_mm"], 0.05);
  EXPECT_EQ(run({"--budget", "2ms"}).exit_code, 0);
  EXPECT_EQ(run({"--budget", "0.0001ms"}).exit_code, 3);
  write_text(m_folder / "still.toml",
             "[volume]\npath = \"ball.nhdr\"\n[[step]]\nfix = [[9, 9, 9]]\n");
  const Outcome still =
      run_supple({"run", m_folder / "still.toml", "--budget", "1s", "-o", m_folder / "c"});
  EXPECT_EQ(still.exit_code, 3);
  EXPECT_NE(still.err.find("no handle that is shifted"), std::string::npos) << still.err;
}

TEST(UnitTradePhases, SolvingIsWhatMovesTheBodyAlone) {
  const RunPhases phases = phases_of({{"reading", 1},
                                      {"solving", 2},
                                      {"relaxing", 4},
                                      {"forces on handles", 8},
                                      {"displacement", 16},
                                      {"inverting", 32},
                                      {"rendering", 64},
                                      {"writing", 128}});
  EXPECT_EQ(phases.prepare_s, 1);
  EXPECT_EQ(phases.solve_s, 6);
  EXPECT_EQ(phases.invert_s, 48);
  EXPECT_EQ(phases.render_s, 64);
}

TEST(UnitTradePhases, NoStageThatReadsOrWritesCountsAsSolving) {
  static const std::regex stage(
      "stage\\(\"((?:read|writ|start|compress|invert|render)[^\"]*)\"\\)");
  int found = 0;
  for (const char* root : {"lib", "volumes", "raycast", "tools/scene"}) {
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(source_dir() + "/" + root)) {
      if (entry.path().extension() != ".cpp") continue;
      const std::string text = read_text(entry.path().string());
      for (std::sregex_iterator match(text.begin(), text.end(), stage), end; match != end;
           ++match, ++found) {
        EXPECT_EQ(phases_of({{(*match)[1], 1}}).solve_s, 0) << (*match)[1];
      }
    }
  }
  EXPECT_GT(found, 10);
}

TEST_F(UnitTradeoff, PlansChooseAmongTheMethodsThatTakeTheScene) {
  ASSERT_EQ(run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "c", "--force", "--state",
                        "ball.vdb"})
                .exit_code,
            0);
  write_text(m_folder / "on.toml",
             "[volume]\npath = \"c/ball.vdb\"\n[[step]]\nrelease = true\ngrab = [5, 5, 5]\n"
             "by = [1, 0, 0]\n");
  const auto run_on = [&](const std::string& budget) {
    return run_supple({"run", m_folder / "on.toml", "--budget", budget, "-o", m_folder / "d"});
  };
  const Outcome of_state = run_on("10min");
  EXPECT_EQ(of_state.exit_code, 0) << of_state.err;
  EXPECT_NE(of_state.err.find("chose fem:0.01 by plans"), std::string::npos) << of_state.err;
  const Outcome brief = run_on("0.001ms");
  EXPECT_EQ(brief.exit_code, 3);
  EXPECT_NE(brief.err.find("that of fem:0.1 by its plan"), std::string::npos) << brief.err;
  const Outcome wrong = run_on("soon");
  EXPECT_NE(wrong.err.find("a time such as 100ms"), std::string::npos) << wrong.err;
}

TEST_F(UnitTradeoff, WhatCannotBeComparedIsSaidInOneLine) {
  const Outcome slow = measure({"--limit", "0.01"});
  EXPECT_EQ(slow.exit_code, 1);
  EXPECT_NE(slow.err.find("no reference: no result after 0.01 s"), std::string::npos) << slow.err;
  const Outcome unknown = measure({"--method", "fern"});
  EXPECT_EQ(unknown.exit_code, 3);
  EXPECT_NE(unknown.err.find("found fern"), std::string::npos) << unknown.err;
  EXPECT_EQ(measure({"--method", "ecm:7"}).exit_code, 3);
  write_text(m_folder / "scene.toml",
             read_text(m_folder / "scene.toml") + "limits = \"tighten\"\n");
  EXPECT_EQ(measure({"--method", "ecm"}).exit_code, 3);
}

}  // namespace
