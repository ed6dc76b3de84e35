// supple replay: a journal or a scene as a live session, and how long its events took.
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tools/commands/deform/operation_command.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/scene/file/measure.h"
#include "tools/scene/live/replay.h"
#include "tools/scene/operation/operation_scene.h"
#include "tools/scene/pictures/picture_writer.h"
#include "tools/scene/run/output_plan.h"
#include "volumes/base/atomic_file.h"
#include "volumes/base/json.h"
#include "volumes/base/memory.h"
#include "volumes/base/toml.h"

namespace supple::tools {

namespace {

struct ReplayFiles {
  std::string input, check, image, film, scene, journal, state, measures;
  bool compares = false;
  double duration_s = 0;
  std::vector<std::string> given;  // options of ReplayOptions that the command line has
};

Value phase_json(const PhaseTimes& times) {
  return {{"count", times.ms.size()},
          {"median_ms", quantile(times.ms, 0.5)},
          {"p95_ms", quantile(times.ms, 0.95)},
          {"max_ms", quantile(times.ms, 1)},
          {"cpu_median_ms", quantile(times.cpu_ms, 0.5)},
          {"cpu_p95_ms", quantile(times.cpu_ms, 0.95)}};
}

Value replay_json(const ReplayReport& report) {
  Value json = {
      {"events", report.events}, {"merged", report.merged}, {"moved_max", report.moved_max}};
  json["solve"] = phase_json(report.of(LivePhase::solve));
  json["prepare"] = phase_json(report.of(LivePhase::prepare));
  json["frame"] = phase_json(report.of(LivePhase::frame));
  json["first_pixels"] = phase_json(report.of(LivePhase::first_pixels));
  json["refined"] = phase_json(report.of(LivePhase::refined));
  json["first_pixels_least_part"] = report.least_part;
  if (!report.first_pixels_ssim.empty()) json["first_pixels_ssim"] = report.first_pixels_ssim;
  return json;
}

void print_phase(const char* name, const PhaseTimes& times) {
  std::printf("%-14s %6zu %9.1f %9.1f %9.1f %9.1f\n", name, times.ms.size(),
              quantile(times.ms, 0.5), quantile(times.ms, 0.95), quantile(times.ms, 1),
              quantile(times.cpu_ms, 0.95));
}

void print_replay(const ReplayReport& report, const std::string& hash, double peak_mb) {
  std::printf("events         %d, %d merged, at most %lld elements moved by one\n", report.events,
              report.merged, static_cast<long long>(report.moved_max));
  std::printf("phase           count median ms    p95 ms    max ms   cpu p95\n");
  print_phase("solve", report.of(LivePhase::solve));
  print_phase("prepare", report.of(LivePhase::prepare));
  print_phase("frame", report.of(LivePhase::frame));
  print_phase("first pixels", report.of(LivePhase::first_pixels));
  print_phase("refined", report.of(LivePhase::refined));
  std::printf("first pixels   at least %.0f %% of the width\n", 100 * report.least_part);
  for (const double ssim : report.first_pixels_ssim) std::printf("ssim           %.4f\n", ssim);
  std::printf("peak memory    %.0f MB\nstate          %s\n", peak_mb, hash.c_str());
}

void write_file(const std::string& path, const std::string& text) {
  AtomicFile file(path);
  std::ofstream out(file.path(), std::ios::binary);
  if (!(out << text << std::flush)) throw_write_error(path, errno);
  file.commit();
}

int run_operation(Table root, const ReplayFiles& files, const ReplayOptions& options,
                  const GlobalOptions& global, Console& console) {
  for (const auto& [text, name] : {std::pair(&files.film, "--film"),
                                   {&files.scene, "--scene"},
                                   {&files.journal, "--journal"},
                                   {&files.state, "--state"},
                                   {&files.measures, "--measures"}}) {
    refuse_option(!text->empty(), name);
  }
  refuse_option(files.compares, "--ssim");
  OperationCommand command;
  for (const std::string& option : files.given) {
    if (option == "--size") {
      command.size = options.size;
    } else {
      refuse_option(true, option.c_str());
    }
  }
  command.is_replay = true;
  command.duration_s = files.duration_s;
  command.image = files.image;
  command.check = files.check;
  return run_operation(std::move(root), command, global, console);
}

int run_replay(const ReplayFiles& files, const ReplayOptions& options, const GlobalOptions& global,
               Console& console) {
  if (std::filesystem::path(files.input).extension() == ".jsonl") {
    return tell_score_of(files.input, global);
  }
  Table root = Table::read(files.input);
  if (is_operation(root)) return run_operation(std::move(root), files, options, global, console);
  if (!files.film.empty() && files.compares) {
    throw InputError({"", "--ssim", "a film", "--ssim without --film, whose pictures are settled"});
  }
  OutputPlan plan(global.force, false);
  plan.protect(files.input);
  if (!files.image.empty()) plan.add_image(files.image);
  if (!files.state.empty()) plan.add_state(files.state);
  if (!files.measures.empty()) plan.add_table(files.measures);
  for (const std::string& path : {files.scene, files.journal}) {
    if (!path.empty()) plan.add_like(path, files.input);
  }
  std::optional<PictureSeries> film;
  if (!files.film.empty()) film.emplace(files.film, options.frames_per_second, files.film);
  Replay replay(std::move(root), options, console, console);
  if (film) plan.add_files(film->files(replay.film_length()));
  console.claim(plan.files());
  if (film) {
    replay.film([&](const Image& image) { film->add(image); });
    film->commit();
  } else {
    replay.run(files.compares);
  }
  const double peak_mb = peak_rss_mb();
  Session& session = replay.live().session();
  const std::string hash = hash_of(session.state());
  if (!files.image.empty()) write_png(files.image, *replay.settled());
  if (!files.scene.empty()) write_file(files.scene, toml_document(replay.live().batch_scene()));
  if (!files.journal.empty()) write_file(files.journal, toml_document(replay.live().journal()));
  if (!files.state.empty()) session.write_state(files.state, &console);
  if (!files.measures.empty()) {
    write_file(files.measures,
               measures_csv(replay.live().history().measures(), replay.displacement()));
  }
  if (global.json) {
    Value json = replay_json(replay.report());
    json["peak_rss_mb"] = peak_mb;
    json["state"] = hash;
    json["outputs"] = plan.files();
    std::printf("%s\n", json_text(json, 2).c_str());
  } else if (!global.quiet) {
    print_replay(replay.report(), hash, peak_mb);
  }
  if (!files.check.empty() && hash_of(read_state(files.check, &console)) != hash) {
    throw Error(files.check + ": another state than the events lead to");
  }
  return kOk;
}

}  // namespace

Command add_replay(CLI::App& program) {
  CLI::App* app = add_subcommand(
      program, "replay", "Run the journal of a live session, or a scene as one, and tell its times",
      "  supple replay session.toml --json\n"
      "  supple replay session.toml --speed 1 --budget 50 --size 512,512\n"
      "  supple replay session.toml --film session.mp4 --size 800,600\n"
      "  supple replay session.toml --check jaw.vdb --scene batch.toml --image jaw.png");
  auto files = std::make_shared<ReplayFiles>();
  auto options = std::make_shared<ReplayOptions>();
  app->add_option("input", files->input,
                  "A journal, or a scene whose steps are its events; the log of an operation tells "
                  "its score")
      ->required()
      ->option_text("JOURNAL|SCENE.toml|LOG.jsonl");
  add_field_options(*app, fields(*options));
  app->add_option("--check", files->check,
                  "Fail unless the events lead to this state; of an operation, to this digest")
      ->option_text("STATE.vdb|DIGEST");
  app->add_option("--duration", files->duration_s,
                  "Of an operation: seconds of it, in place of what its scene says")
      ->check(CLI::PositiveNumber)
      ->option_text("S");
  app->add_option("--image", files->image, "The settled picture")->option_text("F.png");
  app->add_option("--film", files->film,
                  "All of it as pictures at the journal's times: a_%04d.png, .mp4, .webm or .avi")
      ->option_text("F");
  app->add_option("--scene", files->scene, "The events as a scene for `supple run`")
      ->option_text("F.toml");
  app->add_option("--journal", files->journal, "What was carried out, to be replayed")
      ->option_text("F.toml");
  app->add_option("--state", files->state, "The state at the end")->option_text("F.vdb");
  app->add_option("--measures", files->measures, "Distances and angles at rest and at the end")
      ->option_text("F.csv");
  app->add_flag("--ssim", files->compares, "Compare first pixels with what they become");
  return {app, [app, files, options](const GlobalOptions& global, Console& console) {
            for (const char* name : {"--size", "--budget", "--speed", "--fps"}) {
              if (app->get_option(name)->count() > 0) files->given.push_back(name);
            }
            return run_replay(*files, *options, global, console);
          }};
}

}  // namespace supple::tools
