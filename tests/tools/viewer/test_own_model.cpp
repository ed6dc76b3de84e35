// A model that a program adds by one row (creep_model.h) stands wherever those of the library do.
#include <cstdio>

#include <gtest/gtest.h>

#include "lib/session/file/step_keys.h"
#include "tests/support/program.h"
#include "tests/tools/viewer/creep_model.h"
#include "tools/console/program.h"
#include "tools/scene/file/step_method.h"
#include "tools/scene/live/live_session.h"
#include "tools/scene/plan/scene_plan.h"
#include "tools/scene/run/reports.h"
#include "tools/viewer/page_queries.h"
#include "volumes/base/json.h"

using namespace supple;
using namespace supple::test;
using namespace supple::tools;

namespace {

/// Adds the model once, whatever test of this program is the first.
void know_creep() {
  static const bool is_known = (add_model(creep_model()), true);
  ASSERT_TRUE(is_known);
}

constexpr const char* kMaterial =
    "domain = [0, 100]\nactive = [1, 100]\nmax_length = [[0, 1.2]]\nmin_length = [[0, 0.8]]\n"
    "shear = [[0, 0.3]]\nstiffness = [[0, 10]]\n";
constexpr const char* kStep =
    "[[step]]\ngrab = [5, 5, 5]\nby = [3.0, 0.0, 0.0]\nmodel = \"creep\"\n"
    "creep = { voxels = 0.5 }\n";

/// A block of 12 x 12 x 12 voxels, and a scene that lets it creep.
struct Block {
  TemporaryFolder folder;

  Block() {
    know_creep();
    write_text(folder / "block.raw", std::string(12 * 12 * 12, char(100)));
    write_text(folder / "block.nhdr",
               "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 12 12 12\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
               "space origin: (0,0,0)\nencoding: raw\ndata file: block.raw\n");
    write_text(folder / "material.toml", kMaterial);
    write_text(folder / "scene.toml",
               "[volume]\npath = \"block.nhdr\"\n[material]\ntable = \"material.toml\"\n" +
                   std::string(kStep));
  }

  Scene scene() const { return read_scene(folder / "scene.toml"); }
  /// Output of the program, started with these arguments.
  std::string said(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "supple");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    testing::internal::CaptureStdout();
    run_program(int(argv.size()), argv.data(), {"", "", {add_deform, add_run, add_keys}});
    std::fflush(stdout);
    return testing::internal::GetCapturedStdout();
  }
};

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST(UnitOwnModel, ASceneRunsItAndItsJournalAndReportTellOfIt) {
  const Block block;
  const Scene scene = block.scene();
  SessionOptions options;
  options.material = scene.material;
  Session session(scene.volume_path, options);
  const StepRecord& record = session.step(scene.steps.front());
  EXPECT_EQ(record.own_report["steps"].whole(), 7);  // six of half a voxel, and one that rests
  EXPECT_EQ(session.body().offset({5, 5, 5}, 0), 3 * int(kFixedOne));
  EXPECT_EQ(parse_json(session.journal())["steps"].at(0)["creep"]["voxels"], Value(0.5));
  EXPECT_EQ(to_value(record)["model"], Value("creep"));
  EXPECT_EQ(to_value(record)["creep"]["steps"], Value(7));
}

TEST(UnitOwnModel, ItsKeysAreReadAsStrictlyAsThoseOfTheLibrary) {
  know_creep();
  const auto refusal = [](const std::string& keys) -> std::string {
    try {
      Table root = Table::parse("[[step]]\ngrab = [5, 5, 5]\nby = [1, 0, 0]\n" + keys, "s.toml");
      Table step = std::move(root.tables("step").front());
      read_step(step, {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("model = \"creep\"\n"), "");
  EXPECT_TRUE(has(refusal("model = \"creep\"\ncreep = { voxel = 1.0 }\n"), "voxels"));
  EXPECT_TRUE(has(refusal("creep = { voxels = 1.0 }\n"), "creep without its model"));
  EXPECT_TRUE(has(refusal("model = \"creep\"\nrelax = { passes = 3 }\n"), "relax beside creep"));
  EXPECT_TRUE(has(refusal("model = \"crept\"\n"), "creep"));
}

TEST(UnitOwnModel, ACommandHasItsOptionsAndHelpNamesThem) {
  const Block block;
  const std::string help = block.said({"deform", "--help"});
  EXPECT_TRUE(has(help, "ecm|springs|fem|tets|creep")) << help;
  EXPECT_TRUE(has(help, "--creep-voxels"));
  EXPECT_TRUE(has(block.said({"keys", "creep"}), "voxels"));
  const std::string told =
      block.said({"deform", block.folder / "block.nhdr", "--material",
                  block.folder / "material.toml", "--grab", "5,5,5", "--by", "3,0,0", "--model",
                  "creep", "--creep-voxels", "1.5", "-o", block.folder / "out.vdb"});
  EXPECT_TRUE(has(told, "creep           {\"steps\":3,")) << told;
}

TEST(UnitOwnModel, APlanCountsItsCost) {
  const Block block;
  const std::string plan = block.said({"run", block.folder / "scene.toml", "--dry-run"});
  EXPECT_TRUE(has(plan, "elements, some 100 passes")) << plan;
  EXPECT_TRUE(has(plan, "the step moves the body by creep")) << plan;
}

TEST(UnitOwnModel, TradeOffsMeasureItAndAMethodReplacesAnother) {
  const Block block;
  const StepMethod method = parse_method("creep:0.25");
  EXPECT_EQ(method.family->model->name, "creep");
  EXPECT_EQ(method.family->ladder, (std::vector<double>{4, 1, 0.25}));
  EXPECT_EQ(&method_families().back(), method.family);
  Scene scene = block.scene();
  solve_by(scene, parse_method("fem"));
  EXPECT_EQ(model_of(scene.steps.front()).name, "fem");
  solve_by(scene, method);
  EXPECT_EQ(own_settings<CreepStep>(scene.steps.front()).voxels, 0.25);
}

TEST(UnitOwnModel, ThePageOffersItAndALiveSessionDragsByIt) {
  const Block block;
  const Folders folders({block.folder.path()});
  const auto ask = [&](const std::string& kind) {
    return query(parse_page_message(R"({"n": 1, "options": {"kind": ")" + kind + "\"}}"), folders);
  };
  EXPECT_EQ(ask("models").back()["name"], Value("creep"));
  EXPECT_EQ(ask("creep").at(0)["name"], Value("voxels"));

  LiveSession live(
      Table::parse("[volume]\npath = \"" + (block.folder / "block.nhdr") +
                       "\"\n[material]\ntable = \"" + (block.folder / "material.toml") + "\"\n",
                   "live"),
      nullptr);
  Table events = Table::parse(
      "[[event]]\nkind = \"model\"\nmodel = \"creep\"\ncreep = { voxels = 1.0 }\n"
      "[[event]]\nkind = \"grab\"\ngrab = [5, 5, 5]\n"
      "[[event]]\nkind = \"drag\"\nto = [2.0, 0.0, 0.0]\n",
      "events");
  for (Table& event : events.tables("event")) {
    live.carry_out(read_event(event, live.scene().label_names), nullptr);
  }
  EXPECT_EQ(live.model().name, "creep");
  EXPECT_EQ(live.session().records().back().own_report["steps"], Value(3));
}
