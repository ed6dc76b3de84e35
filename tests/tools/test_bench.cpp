#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

using namespace supple::test;

namespace {

/// Rows of a body of 144 elements.
const std::vector<std::string> kTiny = {"bench", "ecm", "--quick", "--only",
                                        "all/noise/12x12x1/+x/rest"};

std::vector<std::string> tiny_with(const std::vector<std::string>& more) {
  std::vector<std::string> arguments = kTiny;
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

}  // namespace

TEST(UnitBench, EcmRowsAsJsonHaveTheDocumentedFields) {
  const TemporaryFolder folder;
  const Outcome outcome = run_supple(tiny_with({"--threads", "2", "--json", folder / "ecm.json"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(read_text(folder / "ecm.json"));
  EXPECT_EQ(json["benchmark"], "ecm");
  EXPECT_FALSE(json["version"].get<std::string>().empty());
  for (const char* key : {"cpu", "cores", "isa", "triad_gb_s"}) {
    EXPECT_TRUE(json["machine"].contains(key)) << key;
  }
  EXPECT_GT(json["machine"]["triad_gb_s"], 0.0);
  std::vector<std::string> engines;
  for (const auto& row : json["rows"]) {
    engines.push_back(row["engine"]);
    EXPECT_EQ(row["case"], "all");
    EXPECT_EQ(row["field"], "noise");
    EXPECT_EQ(row["size"], nlohmann::json({12, 12, 1}));
    EXPECT_EQ(row["direction"], "+x");
    EXPECT_EQ(row["start"], "rest");
    EXPECT_EQ(row["nodes"], 144);
    EXPECT_EQ(row["moved"], 144);
    EXPECT_GT(row["bytes_per_node"], 0.0);
    EXPECT_GT(row["max_list"], 0);
    EXPECT_GE(row["runs"], 1);
    EXPECT_LE(row["min_ms"], row["median_ms"]);
    EXPECT_LE(row["median_ms"], row["max_ms"]);
    const double ns = row["median_ms"].get<double>() * 1e6 / 144;
    EXPECT_NEAR(row["ns_per_node"], ns, 1e-6 * ns);
  }
  EXPECT_EQ(engines, (std::vector<std::string>{"multiset", "bucket", "supple", "supple"}));
  EXPECT_EQ(json["rows"][2]["threads"], 1);
  EXPECT_EQ(json["rows"][3]["threads"], 2);
}

TEST(UnitBench, TheTableShowsEveryRow) {
  const TemporaryFolder folder;
  const Outcome outcome = run_supple(tiny_with({"--threads", "1"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* text : {"ns_per_node", "multiset", "bucket", "supple", "12x12x1"}) {
    EXPECT_NE(outcome.out.find(text), std::string::npos) << text << outcome.out;
  }
}

TEST(UnitBench, APatternWithoutRowsIsAWrongCommandLine) {
  const Outcome outcome = run_supple({"bench", "ecm", "--only", "no-such-row"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("'no-such-row'"), std::string::npos) << outcome.err;
  EXPECT_TRUE(outcome.out.empty());
}

TEST(UnitBench, AnExistingReportNeedsForce) {
  const TemporaryFolder folder;
  write_text(folder / "ecm.json", "precious");
  EXPECT_EQ(run_supple(tiny_with({"--json", folder / "ecm.json"})).exit_code, 2);
  EXPECT_EQ(read_text(folder / "ecm.json"), "precious");
  EXPECT_EQ(run_supple(tiny_with({"--json", folder / "ecm.json", "--force"})).exit_code, 0);
  EXPECT_NE(read_text(folder / "ecm.json"), "precious");
}
