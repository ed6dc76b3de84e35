// A scene as `supple run` has it, with its plan before: run_scene SCENE.toml FOLDER
//
// Cancelled by whoever answers true in Progress::cancelled(); nothing is left behind then.
#include <cstdio>

#include <supple/scene/plan/scene_plan.h>
#include <supple/scene/run/scene_run.h>
#include <supple/supple.h>

namespace {

class Lines final : public supple::Progress {
 public:
  void stage(std::string_view name) override {
    std::printf("%.*s\n", int(name.size()), name.data());
  }
  void update(double) override {}
  bool cancelled() const override { return false; }
  void warn(const std::string& line) override { std::printf("warning: %s\n", line.c_str()); }
};

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) return std::fprintf(stderr, "usage: run_scene SCENE.toml FOLDER\n"), 2;
  Lines progress;
  // [scene]
  const auto scene = supple::tools::open_scene(argv[1]);
  constexpr bool kMayOverwrite = true;  // all is checked before anything is computed
  const auto files = supple::tools::planned_files(*scene, argv[2], kMayOverwrite);
  supple::tools::SceneRun run(*scene, argv[2], true, progress);
  const supple::tools::ScenePlan plan = supple::tools::plan_of(*scene, run);
  run.run();
  // [scene]
  for (const supple::tools::PlanRow& row : plan.rows) {
    std::printf("%s: %s, %.3g s\n", row.stage.c_str(), row.what.c_str(), row.seconds);
  }
  std::printf("%zu files; planned %.3g MB and %.3g s\n", files.size(), plan.peak_mb, plan.seconds);
  return 0;
} catch (const supple::Error& error) {
  return std::fprintf(stderr, "run_scene: %s\n", error.what()), 1;
}
