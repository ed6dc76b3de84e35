// supple run: everything that a scene file asks for.
#include <algorithm>
#include <cstdio>

#include "lib/state/state.h"
#include "tools/commands/deform/operation_command.h"
#include "tools/console/command.h"
#include "tools/console/console.h"
#include "tools/console/dry_run.h"
#include "tools/console/field_options.h"
#include "tools/scene/choice/chosen_method.h"
#include "tools/scene/choice/run_phases.h"
#include "tools/scene/file/draw_method.h"
#include "tools/scene/file/step_method.h"
#include "tools/scene/operation/operation_scene.h"
#include "tools/scene/plan/memory_need.h"
#include "tools/scene/plan/plan_text.h"
#include "tools/scene/plan/scene_plan.h"
#include "tools/scene/run/film_record.h"
#include "tools/scene/run/run_report.h"
#include "tools/scene/run/scene_files.h"
#include "tools/scene/run/scene_run.h"
#include "tools/scene/sweep/sweep_cases.h"
#include "volumes/base/json.h"
#include "volumes/base/memory.h"
#include "volumes/base/relayed_progress.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/toml.h"

namespace supple::tools {

namespace {

struct RunSceneOptions {
  std::string scene;
  std::string folder = ".";
  bool dry_run = false, tells_plan = false;
  bool allow_outside = false;
  bool resume = false;
  std::string frames;
  std::string method, drawing, state;
  std::vector<std::string> set;
  FemStep fem;  // its accuracy, where that is given
  bool has_accuracy = false;
  MethodWanted wanted;
};

Value choice_json(const MethodChoice& choice, double solve_s) {
  return {{"method", choice.method},
          {"expected_solve_s", choice.solve_s},
          {"expected_error_p95_mm", choice.error_mm},
          {"solve_s", solve_s}};
}

void print_results(const SceneRun& run, const Scene& scene, const RunSceneOptions& options,
                   const std::optional<MethodChoice>& choice,
                   const std::optional<ScenePlan>& scene_plan, double planning_s,
                   const GlobalOptions& global, Console& console) {
  const auto stages = console.stage_seconds();
  const double solve_s = phases_of(stages).solve_s;
  if (choice) {
    console.note(choice->method + " took " + number_text(solve_s) + " s to solve, expected were " +
                 number_text(choice->solve_s) + " s");
  }
  double total = 0;
  for (const auto& [name, seconds] : stages) total += seconds;
  const PlanOutcome outcome{peak_rss_mb(), total, processor_seconds() - planning_s};
  if (scene_plan) console.note(outcome_text(*scene_plan, outcome));
  if (global.json) {
    Value json;
    if (scene_plan) {
      json["plan"] = to_value(*scene_plan);
      json["outcome"] = outcome_json(*scene_plan, outcome);
    }
    if (choice) json["chosen"] = choice_json(*choice, solve_s);
    json.update(run_report(run, scene, options.folder, stages));
    std::printf("%s\n", json_text(json, 2).c_str());
    return;
  }
  if (global.quiet) return;
  for (const auto& [name, seconds] : stages) {
    std::printf("%-18s %7.2f s  %3.0f %%\n", name.c_str(), seconds, 100 * seconds / total);
  }
}

/// Chooses the frames to be made; the files of incomplete ones may be there.
void choose_frames(Scene& scene, const RunSceneOptions& options, GlobalOptions& global) {
  if (!scene.film) {
    if (!options.resume && options.frames.empty()) return;
    throw InputError({scene.file, options.resume ? "--resume" : "--frames",
                      "a scene without frames", "a table [film]"});
  }
  scene.film->frames_to_make = frames_of(options.frames, *scene.film);
  scene.film->makes_videos = options.frames.empty();
  if (!options.resume || global.force) return;
  leave_out_made(scene, options.folder);
  global.force = true;
}

OutputPlan files_of(const Scene& scene, const RunSceneOptions& options, bool may_overwrite) {
  try {
    return check_scene(scene, options.folder, may_overwrite);
  } catch (const UsageError& error) {
    if (!scene.film) throw;
    throw UsageError(std::string(error.what()) + ", or --resume to make the missing frames");
  }
}

int run_operation(Table root, const RunSceneOptions& options, const GlobalOptions& global,
                  Console& console) {
  const std::pair<bool, const char*> others[] = {{options.resume, "--resume"},
                                                 {!options.frames.empty(), "--frames"},
                                                 {!options.method.empty(), "--method"},
                                                 {!options.drawing.empty(), "--drawing"},
                                                 {!options.state.empty(), "--state"},
                                                 {options.has_accuracy, "--accuracy"},
                                                 {options.tells_plan, "--plan"},
                                                 {!options.wanted.table.empty(), "--table"},
                                                 {!options.wanted.budget.empty(), "--budget"},
                                                 {!options.wanted.error.empty(), "--error"}};
  for (const auto& [is_given, name] : others) refuse_option(is_given, name);
  OperationCommand command;
  command.folder = options.folder;
  command.allows_outside = options.allow_outside;
  command.is_dry = options.dry_run;
  return run_operation(std::move(root), command, global, console);
}

/// The scene's file with the values of --set.
Table root_of(const RunSceneOptions& options) {
  SweepCases values("--set");
  for (const std::string& text : options.set) values.set(text);
  return Table(values.scene_of(0, read_toml(options.scene), options.scene), options.scene);
}

int run_scene(const RunSceneOptions& options, const GlobalOptions& given, Console& console) {
  Table root = root_of(options);
  if (is_operation(root)) return run_operation(std::move(root), options, given, console);
  Scene scene = read_scene(std::move(root));
  if (!options.method.empty()) solve_by(scene, parse_method(options.method));
  if (options.has_accuracy) solve_to(scene, options.fem.params.accuracy);
  if (!options.drawing.empty()) draw_by(scene, parse_drawing(options.drawing));
  if (!options.state.empty()) scene.output.state = options.state;
  GlobalOptions global = given;
  choose_frames(scene, options, global);
  if (!options.allow_outside) require_inside(scene, options.folder);
  const OutputPlan plan = files_of(scene, options, global.force || options.dry_run);
  const double unchosen_s = processor_seconds();
  CancelOnly progress(&console);  // the run opens the volume once more, and tells
  const std::optional<MethodChoice> choice = choose_method(options.wanted, scene, progress);
  const double choosing_s = processor_seconds() - unchosen_s;
  if (choice) {
    const char* const from = options.wanted.table.empty() ? " by plans of the scene" : "";
    console.note("chose " + choice->method + from + ": expected are " +
                 number_text(choice->solve_s) + " s to solve and an error of " +
                 number_text(choice->error_mm) + " mm (p95)");
    solve_by(scene, parse_method(choice->method));
  }
  if (options.dry_run) return tell_plan(scene, options.folder, global, console);
  if (scene.film && scene.film->frames_to_make.empty() && !scene.film->makes_videos) {
    console.note("all frames are there");
    return kOk;
  }
  console.claim(plan.files());
  require_memory_to_run(scene, &console);
  SceneRun run(scene, options.folder, global.json, console);
  require_memory(scene, run);
  std::optional<ScenePlan> scene_plan;
  const double opened_s = processor_seconds();
  if (options.tells_plan) scene_plan = plan_of(scene, run);
  if (scene_plan && !global.json && !global.quiet) {
    std::printf("%s", text_of_plan(*scene_plan).c_str());
    std::fflush(stdout);
  }
  const double planning_s = choosing_s + processor_seconds() - opened_s;
  run.run();
  print_results(run, scene, options, choice, scene_plan, planning_s, global, console);
  return kOk;
}

}  // namespace

Command add_run(CLI::App& program) {
  auto options = std::make_shared<RunSceneOptions>();
  CLI::App* app = add_subcommand(program, "run", "Run a scene file: deform, render and export",
                                 "  supple run head_drag.toml\n"
                                 "  supple run head_drag.toml -o out/head_drag --force\n"
                                 "  supple run head_film.toml -o frames --resume");
  app->add_option("scene", options->scene, "A scene file")->required()->option_text("SCENE.toml");
  app->add_option("-o,--output", options->folder, "Folder of the outputs, created when missing")
      ->option_text("DIR");
  app->add_flag("--allow-outside", options->allow_outside,
                "Let the scene write outside of DIR: by absolute names and by ..");
  app->add_flag("--resume", options->resume,
                "Of a film, make the frames that are missing, as after an interruption");
  app->add_option("--frames", options->frames, "Of a film, make these frames alone, and no video")
      ->option_text("A:B");
  app->add_option("--table", options->wanted.table,
                  "Measured by supple tradeoff, for --budget and --error to choose from (default: "
                  "plans of the scene, and errors that are shipped)")
      ->option_text("DIR/runs.csv");
  CLI::Option* budget =
      app->add_option("--budget", options->wanted.budget,
                      "The most exact method that solves within a time, such as 100ms")
          ->option_text("TIME");
  CLI::Option* error = app->add_option("--error", options->wanted.error,
                                       "The fastest method to an error, such as 0.5mm (p95)")
                           ->excludes(budget)
                           ->option_text("LENGTH");
  app->add_option("--method", options->method,
                  "What moves the body in place of the scene's models, such as relax-26:64 "
                  "(docs/tradeoff.md)")
      ->excludes(budget)
      ->excludes(error)
      ->option_text("NAME:KNOB");
  add_field_options(*app, {accuracy_field(options->fem).otherwise("what the scene says")});
  CLI::Option* accuracy = app->get_option("--accuracy");
  for (const char* other : {"--budget", "--error", "--method"}) {
    accuracy->excludes(app->get_option(other));
  }
  app->add_option("--drawing", options->drawing,
                  "How views are drawn in place of what they say, such as draw-newton:0.5")
      ->option_text("NAME:KNOB");
  app->add_option("--set", options->set,
                  "A key of the scene, such as step[2].fem.coarsen, and its value in place of what "
                  "the scene says (docs/sweeps.md); repeat for several")
      ->allow_extra_args(false)
      ->option_text("KEY=VALUE");
  app->add_option("--state", options->state, "Also write the state, in place of the scene's")
      ->option_text("NAME.vdb");
  CLI::Option* dry_run =
      app->add_flag("--dry-run", options->dry_run,
                    "Check the scene against its volume and print what would be held and computed, "
                    "and why, with memory and time");
  app->add_flag("--plan", options->tells_plan, "Print that first, and afterwards what came of it")
      ->excludes(dry_run);
  return {app, [options, accuracy](const GlobalOptions& global, Console& console) {
            options->has_accuracy = accuracy->count() > 0;
            return run_scene(*options, global, console);
          }};
}

}  // namespace supple::tools
