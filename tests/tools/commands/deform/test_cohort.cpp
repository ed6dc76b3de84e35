// supple cohort: cases that fail among others, shards, going on, and other people's schedulers.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/base/json.h"

using namespace supple;
using namespace supple::test;

namespace {

namespace fs = std::filesystem;

constexpr int kCases = 11;

constexpr const char* kCohortScene = R"([volume]
path = "p0.nhdr"
[material]
table = "soft.toml"
[[step]]
grab = [4, 4, 4]
by = [1.0, 0.0, 0.0]
)";

constexpr const char* kView = "[[view]]\nimage = \"front view.png\"\nsize = [16, 16]\n";

/// The value without what clocks and the system's memory say.
Value without_times(const Value& value) {
  if (value.is_list()) {
    Value items = Value::List();
    for (const Value& item : value.items()) items.push_back(without_times(item));
    return items;
  }
  if (!value.is_table()) return value;
  Value entries = Value::Entries();
  for (const auto& [key, entry] : value.entries()) {
    const bool is_time =
        key == "total_s" || key == "stage_seconds" || key == "solve_ms" || key == "peak_rss_mb";
    if (!is_time) entries[key] = without_times(entry);
  }
  return entries;
}

std::vector<std::string> lines_in(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

class Cohorts : public testing::Test {
 protected:
  Cohorts() {
    write_soft_material(m_folder / "soft.toml");
    m_folder.write("scene.toml", kCohortScene);
    write_ball(m_folder, "p0", 8);
  }
  /// Cases p0, p1 and so on, each with a scan of its own.
  void write_cases(int count, const std::string& end = "") {
    std::string text = "name,volume,step.by\n";
    for (int n = 0; n < count; ++n) {
      const std::string name = "p" + std::to_string(n);
      if (n > 0) write_ball(m_folder, "" + name, 8 + n % 3);
      text += name + "," + name + ".nhdr,\"[" + std::to_string(n % 4) + ".5, 0, 0]\"\n";
    }
    m_folder.write("cases.csv", text + end);
  }
  Outcome cohort(const std::string& out, std::vector<std::string> more = {},
                 const RunOptions& options = {}) const {
    std::vector<std::string> words = {"cohort", m_folder / "cases.csv", m_folder / "scene.toml",
                                      "-o", m_folder / out};
    words.insert(words.end(), more.begin(), more.end());
    return run_supple(words, options);
  }
  std::string in(const std::string& name) const { return read_text(m_folder / name); }
  bool has(const std::string& name) const { return fs::exists(m_folder / name); }
  std::vector<std::string> untimed(const std::string& name) const {
    std::vector<std::string> lines;
    for (const std::string& line : lines_in(in(name))) {
      lines.push_back(json_text(without_times(parse_json(line))));
    }
    return lines;
  }
  void expect_equal(const std::string& a, const std::string& b) const {
    EXPECT_EQ(untimed(a + "/results.jsonl"), untimed(b + "/results.jsonl"));
    for (const char* file : {"/failures.jsonl", "/results.csv", "/index.html"}) {
      EXPECT_EQ(in(a + file), in(b + file)) << file;
    }
  }
  /// Every folder below cases/ has all that a case leaves.
  int whole_cases(const std::string& out) const {
    int count = 0;
    if (!has(out + "/cases")) return count;
    for (const auto& entry : fs::directory_iterator(m_folder / (out + "/cases"))) {
      ++count;
      for (const char* file : {"front view.png", "result.json", "thumbnail.jpg"}) {
        EXPECT_TRUE(fs::exists(entry.path() / file)) << entry.path() << " " << file;
      }
      EXPECT_FALSE(json_or_null(read_text((entry.path() / "result.json").string())).is_null());
    }
    return count;
  }

  const TemporaryFolder m_folder;
};

using UnitCohort = Cohorts;
using FaultCohort = Cohorts;

TEST_F(UnitCohort, BrokenCasesAreLinesAndThreeShardsTogetherEqualOneRun) {
  RUN_WHEN_SANITIZED();
  write_cases(kCases - 3,
              "gone,nowhere.nhdr,\n"
              "worse,p0.nhdr,\"[1, 2]\"\n"
              "torn,torn.nhdr,\n");
  write_ball(m_folder, "torn", 8);
  m_folder.write("torn.raw", "short");
  const Outcome one = cohort("one", {"--jobs", "2", "--quiet"});
  EXPECT_EQ(one.exit_code, 1) << one.err;
  EXPECT_EQ(lines_in(in("one/results.jsonl")).size(), std::size_t(kCases - 3));
  const std::vector<std::string> failures = lines_in(in("one/failures.jsonl"));
  ASSERT_EQ(failures.size(), 3u);
  EXPECT_EQ(parse_json(failures[0])["name"], Value("gone"));
  EXPECT_NE(failures[0].find("nowhere.nhdr: found no such file"), std::string::npos);
  EXPECT_NE(failures[1].find("found [1, 2], expected three numbers"), std::string::npos);
  EXPECT_NE(failures[2].find("torn.raw: file length: found 5 bytes"), std::string::npos);
  EXPECT_EQ(lines_in(one.err).size(), 3u) << one.err;
  EXPECT_FALSE(has("one/.work"));
  EXPECT_FALSE(has("one/cases/torn"));

  std::vector<std::string> of_shards;
  for (const char* k : {"3", "1", "2"}) {
    cohort("three", {"--shard", std::string(k) + "/3"});
    const std::string end = "-" + std::string(k) + "-of-3.jsonl";
    EXPECT_TRUE(has("three/failures" + end));
    for (std::string& line : untimed("three/results" + end)) of_shards.push_back(std::move(line));
  }
  EXPECT_FALSE(has("three/results.jsonl"));
  const Outcome empty = cohort("empty", {"--gather", "--quiet"});
  EXPECT_EQ(empty.exit_code, 1);
  EXPECT_EQ(lines_in(empty.err).size(), std::size_t(kCases));
  EXPECT_EQ(cohort("empty", {"--gather", "--quiet"}).exit_code, 1) << "it is that of a cohort";
  const Outcome gathered = cohort("three", {"--gather", "--json"});
  EXPECT_EQ(gathered.exit_code, 1) << gathered.err;
  EXPECT_EQ(parse_json(gathered.out)["known"], Value(kCases - 3));
  expect_equal("one", "three");
  std::vector<std::string> sorted = untimed("one/results.jsonl");
  std::sort(sorted.begin(), sorted.end());
  std::sort(of_shards.begin(), of_shards.end());
  EXPECT_EQ(of_shards, sorted);
}

TEST_F(UnitCohort, ACaseIsWhatRunMakesOfTheSceneWithItsValues) {
  m_folder.write("scene.toml", std::string(kCohortScene) + kView);
  write_ball(m_folder, "a,\"b", 9);
  m_folder.write("cases.csv",
                 "step.by,name,volume\n,first,\n\"[2, 0, 0]\",second,\"'a,\"\"b.nhdr'\"\n");
  ASSERT_EQ(cohort("out").exit_code, 0);
  const Outcome run =
      run_supple({"run", m_folder / "scene.toml", "--set", "step[1].by=[2, 0, 0]", "--set",
                  "volume='a,\"b.nhdr'", "-o", m_folder / "alone", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Value line = parse_json(lines_in(in("out/results.jsonl")).at(1));
  EXPECT_EQ(line["name"], Value("second"));
  EXPECT_EQ(json_text(line["values"]), R"({"step.by":[2,0,0],"volume":"a,\"b.nhdr"})");
  Value expected = without_times(parse_json(run.out));
  EXPECT_EQ(json_text(without_times(line["report"])["steps"]), json_text(expected["steps"]));
  EXPECT_EQ(json_text(without_times(line["report"])["certificate"]),
            json_text(expected["certificate"]));
  EXPECT_EQ(in("out/cases/second/front view.png"), in("alone/front view.png"));
  const std::string page = in("out/index.html");
  EXPECT_NE(page.find("<a href=\"cases/second/front%20view.png\"><img loading=\"lazy\" "
                      "alt=\"Picture of second\" src=\"cases/second/thumbnail.jpg\">"),
            std::string::npos)
      << page;
  EXPECT_NE(page.find("<td>a,&quot;b.nhdr</td>"), std::string::npos) << page;
  EXPECT_EQ(lines_in(in("out/results.csv"))[0], "name,step.by,volume,fraction,force_n,error");
}

TEST_F(UnitCohort, OnlyWhatHasChangedIsRunAgain) {
  m_folder.write("scene.toml", std::string(kCohortScene) + kView);
  write_cases(3);
  const auto known = [&](std::vector<std::string> more = {}) {
    more.emplace_back("--json");
    const Outcome outcome = cohort("out", more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return json_or_null(outcome.out)["known"];
  };
  EXPECT_EQ(known(), Value(0));
  const std::string results = in("out/results.jsonl");
  EXPECT_EQ(known(), Value(3));
  EXPECT_EQ(in("out/results.jsonl"), results);
  write_ball(m_folder, "p1", 10);
  EXPECT_EQ(known(), Value(2));
  EXPECT_NE(in("out/results.jsonl"), results);
  fs::remove(m_folder / "out/cases/p2/front view.png");
  EXPECT_EQ(known(), Value(2));
  EXPECT_TRUE(has("out/cases/p2/front view.png"));
  write_cases(2);
  EXPECT_EQ(known(), Value(1)) << "a scan was made anew with other values";
  EXPECT_EQ(lines_in(in("out/results.jsonl")).size(), 2u);
  EXPECT_EQ(known({"--anew"}), Value(0));
  m_folder.write("scene.toml", std::string(kCohortScene) + kView + "fit = \"visible\"\n");
  EXPECT_EQ(known(), Value(0));
  // A case that fails has no results of other values.
  m_folder.write("p1.raw", "short");
  EXPECT_EQ(cohort("out").exit_code, 1);
  EXPECT_FALSE(has("out/cases/p1"));
  EXPECT_NE(cohort("out", {"--gather"}).err.find("p1: "), std::string::npos);
  write_ball(m_folder, "p1", 8);
  EXPECT_NE(cohort("out", {"--gather"}).err.find("p1: not run yet"), std::string::npos);
  EXPECT_EQ(known(), Value(1));
  EXPECT_FALSE(has("out/failed/p1.json"));
}

TEST_F(FaultCohort, InterruptedItLeavesWholeCasesAndGoesOnToTheSame) {
  RUN_WHEN_SANITIZED();
  m_folder.write("scene.toml", std::string(kCohortScene) + kView);
  write_cases(5);
  ASSERT_EQ(cohort("whole").exit_code, 0);
  for (const int signal : {SIGINT, SIGKILL}) {
    const std::string out = "out" + std::to_string(signal);
    RunOptions options;
    options.interrupt_at_file = m_folder / (out + "/cases/p1/result.json");
    options.interrupt_by = signal;
    const Outcome first = cohort(out, {"--jobs", "2"}, options);
    EXPECT_EQ(first.exit_code, 128 + signal) << first.err;
    EXPECT_FALSE(has(out + "/results.jsonl"));
    const int whole = whole_cases(out);
    EXPECT_TRUE(whole >= 1 && whole < 5) << whole;
    if (signal == SIGINT) {
      EXPECT_NE(first.err.find("the same command goes on with the others"), std::string::npos)
          << first.err;
    }
    const Outcome second = cohort(out, {"--json"});
    EXPECT_EQ(second.exit_code, 0) << second.err;
    EXPECT_EQ(json_or_null(second.out)["known"], Value(whole));
    EXPECT_EQ(whole_cases(out), 5);
    EXPECT_FALSE(has(out + "/.work"));
    expect_equal("whole", out);
  }
}

TEST_F(FaultCohort, WrongInputIsRefusedBeforeAnythingRuns) {
  const auto error = [&](const std::string& cases, std::vector<std::string> more = {}) {
    m_folder.write("cases.csv", cases);
    const Outcome outcome = cohort("out", std::move(more));
    EXPECT_FALSE(has("out/cases")) << outcome.err;
    const std::size_t slash = outcome.err.rfind(m_folder.path());
    const std::string line = slash == std::string::npos
                                 ? outcome.err.substr(0, outcome.err.find('\n'))
                                 : outcome.err.substr(slash + m_folder.path().size() + 1);
    return std::to_string(outcome.exit_code) + " " + line.substr(0, line.find('\n'));
  };
  EXPECT_EQ(error("volume\na.nhdr\n"),
            "3 cases.csv:1: found no column 'name', expected one, beside keys of the scene");
  EXPECT_EQ(error("name,volume\na/b,\n"),
            "3 cases.csv:2: name: found 'a/b', expected letters, digits and - _ . within, as it "
            "becomes the name of a folder");
  EXPECT_EQ(error("name,volume\n.a,\n").substr(0, 31), "3 cases.csv:2: name: found '.a'");
  EXPECT_EQ(error("name,volume\na,\na,\n"),
            "3 cases.csv:3: name: found 'a' again, expected each name once");
  EXPECT_EQ(error("name,step.grib\na,1\nb,1\n").substr(0, 75),
            "3 scene.toml: step[1].grib: found an unknown key, expected a known one: did");
  EXPECT_EQ(error("name\na\n", {"--shard", "0/3"}),
            "2 supple: error: --shard: found '0/3', expected K/N, such as 1/3, 2/3 or 3/3");
  EXPECT_EQ(error("name\na\n", {"--shard", "1/3x"}).substr(0, 2), "2 ");
  EXPECT_EQ(error("name\na\n", {"--shard", "1/3", "--gather"}).substr(0, 2), "2 ");
  fs::create_directory(m_folder / "out");
  m_folder.write("out/mine.txt", "mine");
  EXPECT_EQ(error("name\na\n"),
            "2 out: found other files, expected an empty folder, or that of a cohort");
  EXPECT_EQ(in("out/mine.txt"), "mine");
}

TEST_F(FaultCohort, RunRefusesValuesThatNoSceneHas) {
  const auto error = [&](const std::string& value) {
    const Outcome outcome =
        run_supple({"run", m_folder / "scene.toml", "--set", value, "-o", m_folder / "out"});
    EXPECT_FALSE(has("out"));
    return std::to_string(outcome.exit_code) + " " + outcome.err;
  };
  EXPECT_EQ(error("step.by"), "2 supple: error: --set: found 'step.by', expected KEY=VALUE\n");
  EXPECT_EQ(error("a..b=1").substr(0, 37), "2 supple: error: --set: found 'a..b',");
  EXPECT_EQ(error("step.by=[1").substr(0, 35), "2 supple: error: --set: found '[1',");
  EXPECT_NE(error("step[2].by=[1, 0, 0]").find("step[2]: found 1 item"), std::string::npos);
  EXPECT_NE(error("volume=none.nhdr").find("none.nhdr: found no such file"), std::string::npos);
}

/// Recipes of the page, each below its heading: the text of the first block there.
std::string recipe(const std::string& heading) {
  const std::string page = read_text(source_dir() + "/docs/cohort.md");
  const std::size_t begin = page.find("```", page.find("## " + heading)),
                    line = page.find('\n', begin);
  return page.substr(line + 1, page.find("```", line) - line - 1);
}

class InteropCohort : public Cohorts {
 protected:
  /// Runs a command where the program is `supple`; its cases must be all done.
  void expect_all_done(const std::string& command) {
    write_cases(3);
    ASSERT_EQ(cohort("one").exit_code, 0);
    const std::string bin = fs::path(std::getenv("SUPPLE_BINARY")).parent_path().string();
    ASSERT_TRUE(runs("cd " + m_folder.path() + " && PATH=" + bin +
                     ":$PATH HOME=" + m_folder.path() + " " + command));
    expect_equal("one", "out");
    EXPECT_TRUE(has("out/results-8-of-8.jsonl"));
  }
};

TEST_F(InteropCohort, GnuParallelRunsItsRecipe) {
  if (!runs("parallel --version | grep -q GNU")) GTEST_SKIP() << "GNU parallel is not installed";
  m_folder.write("recipe.sh", recipe("GNU parallel"));
  expect_all_done("sh recipe.sh");
}

TEST_F(InteropCohort, SnakemakeRunsItsRecipe) {
  if (!runs("command -v snakemake")) GTEST_SKIP() << "Snakemake is not installed";
  m_folder.write("Snakefile", recipe("Snakemake"));
  expect_all_done("snakemake --cores 2");
}

}  // namespace
