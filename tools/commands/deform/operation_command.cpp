#include "tools/commands/deform/operation_command.h"

#include <cstdio>

#include "lib/operation/operation_log.h"
#include "tools/console/command.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/operation/operation_run.h"
#include "tools/scene/run/output_plan.h"
#include "tools/scene/run/scene_files.h"
#include "volumes/base/json.h"

namespace supple::tools {

namespace {

void print_times(const Value& times) {
  std::printf("%-12s %10s %10s %10s\n", "ms", "median", "p95", "largest");
  for (const auto& [name, phase] : times.entries()) {
    std::printf("%-12s %10.2f %10.2f %10.2f\n", name.c_str(), phase["median_ms"].number(),
                phase["p95_ms"].number(), phase["max_ms"].number());
  }
}

void print_score(const Value& score) {
  for (const auto& [key, category] : score["categories"].entries()) {
    std::printf("%-22s %5.1f of 100\n", category["title"].text().c_str(),
                category["points"].number());
  }
  for (const Value& task : score["tasks"].items()) {
    std::printf("task %-17s %5.1f %%\n", task["name"].text().c_str(),
                100 * task["progress"].number());
  }
}

/// Membranes of which triangles turned over, as what is told of them then is worth less.
void print_inverted(const Value& membranes) {
  for (const auto& [name, one] : membranes.entries()) {
    const int most = int(one["most_inverted_triangles"].number());
    if (most == 0) continue;
    std::printf("%-12s %d of its triangles faced backwards at once, %d at the end\n", name.c_str(),
                most, int(one["inverted_triangles"].number()));
  }
}

void print_report(const Value& report) {
  std::printf("%d steps, %.2f s of operation in %.2f s, load %.1f\n", int(report["steps"].number()),
              report["time_s"].number(), report["wall_s"].number(), report["load"].number());
  print_times(report["times"]);
  if (report.contains("pictures_per_s")) {
    std::printf("%.1f %s per second", report["pictures_per_s"].number(),
                report["pairs"].truth() ? "pairs" : "pictures");
    if (report.contains("settled_ssim")) {
      std::printf(", SSIM to settled ones %.4f", report["settled_ssim"].number());
    }
    std::printf("\n");
  }
  const Value& memory = report["memory_mb"];
  std::printf("memory       %.0f MB at a tenth, %.0f at half, %.0f at the end\n",
              memory["at_a_tenth"].number(), memory["at_half"].number(),
              memory["at_the_end"].number());
  print_inverted(report["membranes"]);
  print_score(report["score"]);
  std::printf("state        %s\n", report["digest"].text().c_str());
}

/// Nothing is written but an image of the first view at the end, where it is asked for.
void see_first_view(OperationScene& scene, const std::string& image, OperationOptions& options) {
  scene.output = {};
  for (MicroscopeView& view : scene.views) view.image = view.video = "";
  if (!scene.volume) {
    if (!image.empty()) scene.views.front().image = image;
    return;
  }
  std::vector<SceneView>& views = scene.volume->views;
  if (!views.empty()) options.volume_view = std::make_shared<const SceneView>(views.front());
  options.volume_image = image;
  views.clear();
}

}  // namespace

void refuse_option(bool is_given, const char* option) {
  if (!is_given) return;
  throw UsageError(std::string(option) + ": an operation has none; it is for scenes of a volume");
}

int tell_score_of(const std::string& log, const GlobalOptions& global) {
  const Value score = to_value(score_of_log(log));
  if (global.json) {
    std::printf("%s\n", json_text(score, 2).c_str());
  } else {
    print_score(score);
  }
  return kOk;
}

int run_operation(Table root, const OperationCommand& command, const GlobalOptions& global,
                  Console& console) {
  OperationScene scene = read_operation(std::move(root));
  OperationOptions options;
  if (command.duration_s > 0) scene.duration_s = command.duration_s;
  for (const auto& [is_given, option] :
       {std::pair(command.size.has_value(), "--size"), {!command.image.empty(), "--image"}}) {
    if (!is_given || !(scene.volume ? scene.volume->views.empty() : scene.views.empty())) continue;
    throw InputError({scene.file, "view", "none", std::string("a table [[view]] for ") + option});
  }
  if (command.size) {
    (scene.volume ? scene.volume->views.front().size : scene.views.front().size) = *command.size;
  }
  if (command.is_replay) {
    // A run makes missing folders, a replay none.
    if (!command.image.empty()) OutputPlan(true).add_image(command.image);
    see_first_view(scene, command.image, options);
  }
  if (!command.is_replay && !command.allows_outside) {
    require_inside(scene.outputs(), scene.file, command.folder);
  }
  options.draws_every_step = command.is_replay && !command.is_dry;
  OperationRun run(scene, command.folder, options, console);
  const OutputPlan plan = run.plan(global.force || command.is_dry);
  if (command.is_dry) {
    std::printf("%d steps of %g s\n", scene.step_count(), scene.setup.step_s);
    for (const std::string& file : plan.files()) std::printf("%s\n", file.c_str());
    return kOk;
  }
  console.claim(plan.files());
  run.run(console);
  Value report = run.report();
  report["outputs"] = plan.files();
  if (global.json) {
    std::printf("%s\n", json_text(report, 2).c_str());
  } else if (!global.quiet) {
    console.clear_line();
    print_report(report);
  }
  if (!command.check.empty() && command.check != report["digest"].text()) {
    throw Error(scene.file + ": leads to state " + report["digest"].text() + ", not " +
                command.check);
  }
  return kOk;
}

}  // namespace supple::tools
