// Keys of a scene as users write them, the cases that they make, and names of results.
#include <gtest/gtest.h>

#include "tests/support/errors.h"
#include "tests/support/temporary_folder.h"
#include "tools/scene/chart/chart.h"
#include "tools/scene/sweep/report_names.h"
#include "tools/scene/sweep/sweep_cases.h"
#include "tools/scene/sweep/sweep_journal.h"
#include "tools/scene/sweep/sweep_table.h"
#include "volumes/base/json.h"
#include "volumes/base/toml.h"

using namespace supple;
using namespace supple::test;
using namespace supple::tools;

namespace {

constexpr const char* kScene = R"(
[volume]
path = "a.nrrd"
[[step]]
grab = [1, 2, 3]
[step.fem]
swellings = [{ name = "left", pressure_kpa = 1 }, { name = "right", pressure_kpa = 1 }]
[[step]]
by = [1.0, 2.0, 3.0]
[step.fem]
swellings = [{ name = "left", pressure_kpa = 1 }, { grab = [1, 1, 1] }]
)";

/// The step tables after a key was set, as JSON.
std::string steps_with(const std::string& key, const Value& value) {
  Value root = parse_toml(kScene, "s.toml");
  SceneKey(key).set(root, "s.toml", value);
  return json_text(root["step"]);
}

std::vector<std::string> titles(const SweepCases& cases) {
  std::vector<std::string> all;
  for (std::size_t n = 0; n < cases.size(); ++n) all.push_back(cases.title(n));
  return all;
}

TEST(UnitSceneKey, AKeyStandsForEveryTableThatHasIt) {
  const std::string all = steps_with("step.fem.swellings.pressure_kpa", 7);
  EXPECT_EQ(all, R"([{"fem":{"swellings":[{"name":"left","pressure_kpa":7},)"
                 R"({"name":"right","pressure_kpa":7}]},"grab":[1,2,3]},)"
                 R"({"by":[1.0,2.0,3.0],"fem":{"swellings":[{"name":"left","pressure_kpa":7},)"
                 R"({"grab":[1,1,1]}]}}])");
  EXPECT_EQ(steps_with("step[2].fem.swellings[left].pressure_kpa", 7),
            R"([{"fem":{"swellings":[{"name":"left","pressure_kpa":1},)"
            R"({"name":"right","pressure_kpa":1}]},"grab":[1,2,3]},)"
            R"({"by":[1.0,2.0,3.0],"fem":{"swellings":[{"name":"left","pressure_kpa":7},)"
            R"({"grab":[1,1,1]}]}}])");
  EXPECT_NE(steps_with("step[1].grab[2]", 9).find(R"("grab":[1,9,3])"), std::string::npos);
}

TEST(UnitSceneKey, AKeyThatIsNowhereGoesWhereverItCouldBe) {
  const std::string added = steps_with("step.fem.coarsen", 1);
  EXPECT_NE(added.find(R"("fem":{"coarsen":1,)"), std::string::npos);
  EXPECT_NE(added.find(R"("fem":{"coarsen":1,)", added.find("by")), std::string::npos);
  EXPECT_NE(steps_with("step[2].relax.passes", 3).find(R"("relax":{"passes":3}}])"),
            std::string::npos);
}

TEST(UnitSceneKey, ATextInPlaceOfATableWithAPathIsThatPath) {
  Value root = parse_toml("[volume]\npath = \"a.nrrd\"\nchannel = 1\n", "");
  SceneKey("volume").set(root, "s.toml", "b.nrrd");
  EXPECT_EQ(json_text(root), R"({"volume":{"channel":1,"path":"b.nrrd"}})");
  SceneKey("volume").set(root, "s.toml", parse_swept("{ path = 'c' }").value);
  SceneKey("labels").set(root, "s.toml", "l.nrrd");
  EXPECT_EQ(json_text(root), R"({"labels":"l.nrrd","volume":{"path":"c"}})");
}

TEST(UnitSceneKey, ATableThatIsNotThereIsNamed) {
  const auto error = [](const std::string& key) {
    return input_error([&] { steps_with(key, 1); });
  };
  EXPECT_EQ(error("step[3].model"), "s.toml: step[3]: found 2 items, expected 1 to 2");
  EXPECT_EQ(error("step[1].fem.swellings[middle].pressure_kpa"),
            "s.toml: step[1].fem.swellings[middle]: found 2 items, expected 1 to 2, left, right");
  EXPECT_EQ(error("volume.path.x"),
            "s.toml: volume.path: found 'a.nrrd', expected a table that has x");
  EXPECT_EQ(error("view[1].size"), "s.toml: view[1]: found no view, expected a list of them");
  for (const char* text : {"", ".", "a..b", "a.", "step[].x", "step[1", "a b", "\"a"}) {
    EXPECT_NE(error_of([&] { SceneKey key(text); }), "") << text;
  }
}

TEST(UnitSceneKey, AMaterialOfAFileIsTakenIn) {
  const TemporaryFolder folder;
  folder.write("soft.toml", "poisson = [[0, 0.3]]\n[label.\"left lobe\"]\npreset = \"brain\"\n");
  Value root = parse_toml("[material]\ntable = \"soft.toml\"\n", "");
  SceneKey("material.poisson").set(root, folder / "s.toml", 0.4);
  SceneKey("material.label.\"left lobe\".stiffness").set(root, folder / "s.toml", 2);
  EXPECT_EQ(json_text(root["material"]),
            R"({"label":{"left lobe":{"preset":"brain","stiffness":2}},"poisson":0.4})");
  SceneKey("material").set(root, folder / "s.toml", parse_swept("{ table = 'other.toml' }").value);
  EXPECT_EQ(json_text(root["material"]), R"({"table":"other.toml"})");
}

TEST(UnitSweepCases, TheLastKeyChangesFastest) {
  SweepCases cases;
  EXPECT_EQ(titles(cases), (std::vector<std::string>{"the scene as it is"}));
  cases.vary("material.poisson=0.3,0.45");
  cases.vary("step.model= ecm, fem ");
  EXPECT_EQ(titles(cases), (std::vector<std::string>{
                               "material.poisson = 0.3, step.model = ecm",
                               "material.poisson = 0.3, step.model = fem",
                               "material.poisson = 0.45, step.model = ecm",
                               "material.poisson = 0.45, step.model = fem",
                           }));
  EXPECT_EQ(cases.short_key(0), "poisson");
  EXPECT_NE(error_of([&] { cases.vary("step.model=fem"); }), "");
}

TEST(UnitSweepCases, AValueIsWhatASceneHasOrAWord) {
  const auto json = [](const std::string& text) {
    std::string all;
    for (const SweptValue& value : parse_swept_list(text)) all += json_text(value.value) + " ";
    return all;
  };
  EXPECT_EQ(json("1,0.5,-2e3,true"), "1 0.5 -2000.0 true ");
  EXPECT_EQ(json("[1,2],[[0,0.3],[1,2]]"), "[1,2] [[0,0.3],[1,2]] ");
  EXPECT_EQ(json("{name=\"a,b\",toward=[1,0,0]},'x,y',z"),
            R"({"name":"a,b","toward":[1,0,0]} "x,y" "z" )");
  EXPECT_EQ(json("2mm.nrrd,a#b,1 2"), R"("2mm.nrrd" "a#b" "1 2" )");
  for (const char* text : {"", "1,,2", "[1", "{a", "\"x"}) {
    EXPECT_NE(error_of([&] { parse_swept_list(text); }), "") << text;
  }
}

TEST(UnitSweepCases, AFileHasValuesThatGoTogether) {
  const TemporaryFolder folder;
  folder.write("cases.csv",
               "\xEF\xBB\xBFstep.model,step[1].grab\r\nfem,\"[1, 2, 3]\"\r\n\r\necm,\r\n");
  SweepCases cases;
  cases.add_file(folder / "cases.csv");
  cases.vary("material.poisson=0.3");
  EXPECT_EQ(titles(cases), (std::vector<std::string>{
                               "step.model = fem, step[1].grab = [1, 2, 3], material.poisson = 0.3",
                               "step.model = ecm, material.poisson = 0.3"}));
  const auto error_with = [&](const std::string& text) {
    folder.write("cases.csv", text);
    const std::string line = input_error([&] { SweepCases().add_file(folder / "cases.csv"); });
    return line.substr(std::min(line.size(), folder.path().size() + 1));
  };
  EXPECT_EQ(error_with("a,b\n1\n"),
            "cases.csv:2: found 1 value, expected 2 keys as the first line has");
  EXPECT_EQ(error_with("a,a\n1,2\n"),
            "cases.csv:1: found 'a', expected keys of the scene, each once");
  EXPECT_EQ(error_with("a\n[1\n"), "cases.csv:2: found '[1', expected a value as scenes have it");
  EXPECT_EQ(error_with("a,b\n\"[1,\n2]\",3\n[1,4\n"),
            "cases.csv:4: found '[1', expected a value as scenes have it");
  EXPECT_EQ(error_with("a\n"), "cases.csv: found no line below its keys, expected a line per case");
  EXPECT_EQ(error_with(""), "cases.csv: found an empty file, expected keys, and a line per case");
}

TEST(UnitSweepCases, KeysOfWhichOneUndoesAnotherAreRefused) {
  const auto error_with = [](const std::vector<std::string>& keys, std::size_t n = 0) {
    SweepCases cases;
    for (const std::string& key : keys) cases.vary(key);
    return error_of([&] { cases.scene_of(n, parse_toml(kScene, "s.toml"), "s.toml"); });
  };
  const std::vector<std::string> all_and_one = {"step.fem.coarsen=1,2", "step[1].fem.coarsen=2"};
  EXPECT_EQ(error_with(all_and_one),
            "step.fem.coarsen = 1, step[1].fem.coarsen = 2: found one value that replaces the "
            "other, expected keys of different values");
  EXPECT_EQ(error_with(all_and_one, 1), "") << "both are 2";
  EXPECT_NE(error_with({"step[2].by[2]=1,2", "step[2].by=[0, 0, 5]"}), "");
  EXPECT_NE(error_with({"step[2].by=[0, 0, 5]", "step[2].by[2]=1,2"}), "");
  EXPECT_NE(error_with({"volume.\"path\"=a", "volume.path=b"}), "");
  EXPECT_NE(error_with({"step.fem.swellings[left].pressure_kpa=2",
                        "step.fem.swellings=[{ grab = [1, 1, 1], pressure_kpa = 3.0 }]"}),
            "");
  for (const std::vector<std::string>& apart : std::vector<std::vector<std::string>>{
           {"step[1].fem.coarsen=1", "step[2].fem.coarsen=2"},
           {"step[2].by[1]=1", "step[2].by[2]=2"},
           {"step.fem.swellings[left].pressure_kpa=1",
            "step[1].fem.swellings[right].pressure_kpa=2"},
           {"step[1].relax={ passes = 3 }", "step[1].relax.start=true"}}) {
    EXPECT_EQ(error_with(apart), "");
  }
}

TEST(UnitSweepCases, AMaterialOfOneOfSeveralFilesIsChanged) {
  const TemporaryFolder folder;
  folder.write("soft.toml", "poisson = [[0, 0.3]]\nstiffness = 2\n");
  SweepCases cases;
  cases.vary("material.table=soft.toml");
  cases.vary("material.poisson=0.4");
  const Value root = parse_toml("[material]\ntable = \"none.toml\"\n", "");
  EXPECT_EQ(json_text(cases.scene_of(0, root, folder / "s.toml")["material"]),
            R"({"poisson":0.4,"stiffness":2})");
}

TEST(UnitSweepTable, CellsAreCleanAndCutBetweenCharacters) {
  std::string longest;
  for (int n = 0; n < 61; ++n) longest += "\u03bd";
  SweepTable table;
  table.keys = {"k"};
  table.rows = {{{"a\033[2J\nb"}, {}, ""}, {{longest}, {}, ""}};
  const std::string text = to_text(table, [](std::string cell) {
    for (char& c : cell) c = c >= 0 && c < ' ' ? '?' : c;
    return cell;
  });
  EXPECT_EQ(text.substr(0, 61), std::string(59, ' ') + "k\n");
  EXPECT_NE(text.find("a?[2J?b\n"), std::string::npos) << text;
  EXPECT_NE(text.find(longest.substr(0, 2 * 57) + "...\n"), std::string::npos) << text;
}

TEST(UnitSweepJournal, AFileThatCannotBeReadIsNoEmptyJournal) {
  EXPECT_NE(error_of([] { SweepJournal("/proc/self/mem", "digest", false); }), "");
}

TEST(UnitReportNames, AVectorAlsoHasALength) {
  const Value report = parse_json(
      R"({"steps":[{"model":"fem","fem":{"volume_change_ml":2.5,"turned_voxel":[1,2,3]},
      "reactions":[{"force_n":[3,4,0]}]}],"total_s":1})");
  std::string names;
  for (const auto& [name, value] : named_values(report)) {
    names += name + "=" + json_text(value) + (is_main_result(name) ? "*\n" : "\n");
  }
  EXPECT_EQ(names,
            "steps[0].model=\"fem\"\nsteps[0].fem.volume_change_ml=2.5*\n"
            "steps[0].fem.turned_voxel[0]=1\nsteps[0].fem.turned_voxel[1]=2\n"
            "steps[0].fem.turned_voxel[2]=3\nsteps[0].reactions[0].force_n=5.0*\n"
            "steps[0].reactions[0].force_n[0]=3\nsteps[0].reactions[0].force_n[1]=4\n"
            "steps[0].reactions[0].force_n[2]=0\ntotal_s=1\n");
  const NamedValues all = named_values(report);
  EXPECT_EQ(find_named(all, "volume_change_ml")->second, Value(2.5));
  EXPECT_EQ(find_named(all, "force_n[1]")->second, Value(4));
  EXPECT_EQ(find_named(all, "change_ml"), nullptr);
  EXPECT_EQ(words_of("steps[0].fem.volume_change_ml"), "volume change (ml)");
  EXPECT_EQ(words_of("material.poisson"), "poisson");
}

TEST(UnitChart, DecadesBeginWithTheLeastValue) {
  Chart chart;
  chart.x_kind = AxisSteps::decades;
  chart.curves = {{"a", {{1e-9, 1e-9, 1e-9, 1, "", ""}, {1e-7, 1e-7, 1e-7, 2, "", ""}}}};
  const std::string svg = to_svg_file(chart);
  EXPECT_NE(svg.find("cx=\"76\""), std::string::npos) << svg;
  EXPECT_NE(svg.find("cx=\"554\""), std::string::npos) << svg;
}

TEST(UnitChart, EvenAxesBeginAndEndOnATick) {
  Chart chart;
  chart.x_name = "pressure (kPa)";
  chart.y_name = "volume (ml)";
  chart.curves = {{"a", {{1, 1, 1, -0.013, "", ""}, {4, 4, 4, 0.027, "", ""}}}};
  std::string svg = to_svg_file(chart);
  for (const char* tick :
       {">1</text>", ">4</text>", ">-0.015</text>", ">0</text>", ">0.03</text>"}) {
    EXPECT_NE(svg.find(tick), std::string::npos) << tick << svg;
  }
  EXPECT_EQ(svg.find("class=\"floor\""), std::string::npos);
  EXPECT_EQ(svg.find("no other beats it"), std::string::npos);
  chart.x_kind = AxisSteps::words;
  chart.x_words = {"ecm", "f<m"};
  chart.curves = {{"a", {{0, 0, 0, 5, "", ""}, {1, 1, 1, 5, "", ""}}}};
  svg = to_svg_file(chart);
  EXPECT_NE(svg.find(">f&lt;m</text>"), std::string::npos);
  EXPECT_NE(svg.find(">5</text>"), std::string::npos) << "a flat curve has an axis, too";
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

}  // namespace
