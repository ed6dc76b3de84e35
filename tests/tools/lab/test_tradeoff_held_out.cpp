// A load held out: choices from other loads are judged by it, and never made by it.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tools/lab/tradeoff/held_out.h"

using namespace supple::test;
using namespace supple::tools;

namespace {

TradeRow load_row(const std::string& scene, const std::string& method, double knob, double time_s,
                  double error_mm) {
  TradeRow row;
  row.scene = scene;
  row.method = method;
  row.knob = knob;
  row.status = "ok";
  row.solve_s = {time_s, time_s, time_s};
  row.p95_mm = error_mm;
  row.held_out = scene == "held.toml" ? 1 : 0;
  return row;
}

/// Rows of a fast method and an exact one: two loads as given, and the one that is held out.
std::vector<TradeRow> three_loads(double fast_s, double fast_mm, double exact_s, double exact_mm) {
  return {load_row("a.toml", "ecm", 6, 0.010, 0.7),
          load_row("a.toml", "fem", 0.1, 0.4, 0.020),
          load_row("b.toml", "ecm", 6, 0.008, 0.8),
          load_row("b.toml", "fem", 0.1, 0.5, 0.010),
          load_row("held.toml", "ecm", 6, fast_s, fast_mm),
          load_row("held.toml", "fem", 0.1, exact_s, exact_mm)};
}

const HeldOutChoice& choice_for(const std::vector<HeldOutChoice>& choices, bool is_budget,
                                double asked) {
  for (const HeldOutChoice& choice : choices) {
    if (choice.is_budget == is_budget && choice.asked == asked) return choice;
  }
  throw std::runtime_error("nothing asked so");
}

TEST(UnitHeldOut, RatiosAreToTheWorstOfTheOtherLoads) {
  const auto choices = check_held_out(three_loads(0.012, 0.4, 0.6, 0.025), 1e-4);
  ASSERT_EQ(choices.size(), 8u);
  const HeldOutChoice& fast = choice_for(choices, true, 0.016);
  ASSERT_TRUE(fast.chosen);
  EXPECT_EQ(fast.chosen->method, "ecm:6");
  EXPECT_EQ(fast.row, 4u);
  EXPECT_DOUBLE_EQ(fast.time_ratio, 1.2);
  EXPECT_DOUBLE_EQ(fast.error_ratio, 0.5);
  const HeldOutChoice& exact = choice_for(choices, false, 0.1);
  EXPECT_EQ(exact.chosen->method, "fem:0.1");
  EXPECT_DOUBLE_EQ(exact.time_ratio, 1.2);
  EXPECT_DOUBLE_EQ(exact.error_ratio, 1.25);
  EXPECT_EQ(summary_of(choices).substr(0, 6), "8 of 8");
}

TEST(UnitHeldOut, APromiseIsBrokenByTimeAndByError) {
  const auto slow = check_held_out(three_loads(0.016, 0.4, 0.6, 0.02), 1e-4);
  EXPECT_FALSE(choice_for(slow, true, 0.016).is_kept);
  EXPECT_TRUE(choice_for(slow, true, 1).is_kept);
  const auto wrong = check_held_out(three_loads(0.010, 0.4, 0.5, 0.031), 1e-4);
  EXPECT_TRUE(choice_for(wrong, true, 0.016).is_kept);
  EXPECT_FALSE(choice_for(wrong, true, 1).is_kept);
  EXPECT_EQ(summary_of(wrong).substr(0, 6), "4 of 8");
  EXPECT_TRUE(choice_for(check_held_out(three_loads(0.01, 0.4, 0.5, 0.031), 0.03), true, 1).is_kept)
      << "what is below the floor is no error";
}

TEST(UnitHeldOut, WhatFailsUnderItIsNotKeptAndWhatNoneReachesIsNoChoice) {
  std::vector<TradeRow> rows = three_loads(0.01, 0.4, 0.5, 0.01);
  rows[5].status = "failed";
  const auto choices = check_held_out(rows, 1e-4);
  const HeldOutChoice& exact = choice_for(choices, true, 60);
  EXPECT_EQ(exact.chosen->method, "fem:0.1") << "the held-out load has no say";
  EXPECT_FALSE(exact.is_ok);
  EXPECT_FALSE(exact.is_kept);
  rows = {rows[0], rows[2], rows[4]};
  const auto few = check_held_out(rows, 1e-4);
  EXPECT_FALSE(choice_for(few, false, 0.1).chosen);
  EXPECT_EQ(summary_of(few).substr(0, 6), "6 of 6");
}

class UnitHeldOutLoad : public ::testing::Test {
 protected:
  void SetUp() override {
    write_ball(m_folder, "ball", 10);
    write_soft_material(m_folder / "m.toml");
    write_load("a", "0.0, 0.6, 0.0");
    write_load("b", "0.5, 0.0, 0.0");
    write_load("held", "0.0, 0.5, 0.4");
  }
  void write_load(const std::string& name, const std::string& by) {
    write_text(m_folder / (name + ".toml"),
               "[volume]\npath = \"ball.nhdr\"\n[material]\ntable = \"m.toml\"\n[[step]]\n"
               "grab = [5, 8, 5]\nby = [" +
                   by + "]\nfix = [[0, 0, 0, 9, 2, 9]]\n");
  }
  /// `more`: loads and options.
  Outcome measure(const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"tradeoff", m_folder / "a.toml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    for (const char* word :
         {"-o", "out", "--runs", "1", "--method", "ecm:6", "--method", "fem:0.1"}) {
      arguments.push_back(word == std::string("out") ? m_folder / "out" : word);
    }
    return run_supple(arguments);
  }
  std::vector<TradeRow> rows() const {
    return rows_from_csv(read_text(m_folder / "out/runs.csv"), "runs.csv");
  }

  TemporaryFolder m_folder;
};

TEST_F(UnitHeldOutLoad, ItIsMeasuredAndDrawnAndInNoTable) {
  const Outcome outcome = measure({m_folder / "b.toml", "--held-out", m_folder / "held.toml"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("keep their promise"), std::string::npos) << outcome.err;
  const std::vector<TradeRow> all = rows();
  ASSERT_EQ(all.size(), 9u);
  for (std::size_t r = 0; r < all.size(); ++r) EXPECT_EQ(all[r].held_out, r < 6 ? 0 : 1) << r;
  const auto json = nlohmann::json::parse(read_text(m_folder / "out/tradeoff.json"));
  EXPECT_TRUE(json["scenes"][1]["solving"].contains("time_to_error_s"));
  EXPECT_FALSE(json["scenes"][2]["solving"].contains("time_to_error_s"));
  EXPECT_FALSE(json["scenes"][2]["solving"].contains("error_within_time"));
  ASSERT_EQ(json["held_out"]["choices"].size(), 8u);
  for (const auto& choice : json["held_out"]["choices"]) {
    if (choice["method"].is_null()) continue;
    const TradeRow& row = all.at(choice["row"].get<std::size_t>());
    EXPECT_EQ(row.name(), choice["method"]);
    EXPECT_EQ(row.held_out, 1);
    EXPECT_EQ(row.solve_s.median, choice["held_out"]["solve_s"]);
  }
  const std::string page = read_text(m_folder / "out/index.html");
  const std::size_t held = page.find("<h2>" + (m_folder / "held.toml"));
  ASSERT_NE(held, std::string::npos);
  EXPECT_EQ(page.find("within a time", held), std::string::npos) << "no table of matched time";
  EXPECT_NE(page.find("What choices from the other loads did here", held), std::string::npos);
  EXPECT_NE(page.find("<svg", held), std::string::npos);
}

TEST_F(UnitHeldOutLoad, ARunChoosesWithoutItUnlessALaterCallTakesItIn) {
  ASSERT_EQ(measure({"--held-out", m_folder / "held.toml"}).exit_code, 0);
  std::vector<TradeRow> changed = rows();
  for (TradeRow& row : changed) {
    if (row.held_out != 0) row.solve_s.median = 100;
  }
  write_text(m_folder / "out/runs.csv", to_csv(changed));
  const std::vector<std::string> chosen = {
      "run",     m_folder / "a.toml",       "-o",       m_folder / "c",
      "--table", m_folder / "out/runs.csv", "--budget", "1min"};
  EXPECT_EQ(run_supple(chosen).exit_code, 0);
  ASSERT_EQ(measure({m_folder / "held.toml"}).exit_code, 0);
  ASSERT_EQ(rows().size(), 6u);
  EXPECT_EQ(rows().back().held_out, 0);
  EXPECT_EQ(run_supple(chosen).exit_code, 3) << "no method is so fast under every load";
}

TEST_F(UnitHeldOutLoad, TheSameLoadTwiceIsRefused) {
  const Outcome twice = measure({"--held-out", m_folder / "a.toml"});
  EXPECT_EQ(twice.exit_code, 3);
  EXPECT_NE(twice.err.find("scenes of different names"), std::string::npos) << twice.err;
}

}  // namespace
