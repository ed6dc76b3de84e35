// supple cohort: a scene run for each of many cases, each in a process of its own.
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "tools/console/command.h"
#include "tools/scene/cohort/cohort_page.h"
#include "tools/scene/run/output_plan.h"
#include "volumes/base/files.h"
#include "volumes/base/json.h"
#include "volumes/base/parallel.h"

namespace supple::tools {

namespace {

struct CohortOptions {
  std::string cases, scene, folder, shard;
  CohortWork work;
  bool gathers = false;

  std::string file(const std::string& name, const std::string& extension) const {
    const std::string all = name + work.part.suffix() + extension;
    return (std::filesystem::path(folder) / all).string();
  }
  std::string results() const { return file("results", ".jsonl"); }
  std::string failures() const { return file("failures", ".jsonl"); }
};

/// A shard leaves lines; table and page are of all cases.
std::vector<std::string> files_of(const CohortOptions& options) {
  OutputPlan plan(true, true);
  plan.protect(options.scene);
  plan.protect(options.cases);
  plan.add_log(options.results());
  plan.add_log(options.failures());
  std::vector<std::string> files = plan.files();
  if (options.work.part.shards > 1) return files;
  files.push_back(options.file("results", ".csv"));
  files.push_back(options.file("index", ".html"));
  return files;
}

void write_files(const CohortOptions& options, const Cohort& cohort,
                 const std::vector<CohortEnd>& ends) {
  replace_text_file(options.results(), lines_of(ends, false));
  replace_text_file(options.failures(), lines_of(ends, true));
  if (options.work.part.shards > 1) return;
  replace_text_file(options.file("results", ".csv"), to_csv(table_of(cohort, ends)));
  replace_text_file(options.file("index", ".html"), cohort_page(cohort, ends));
}

void print_summary(const CohortOptions& options, const std::vector<CohortEnd>& ends,
                   const GlobalOptions& global, Console& console) {
  std::size_t known = 0;
  for (const CohortEnd& end : ends) known += end.error.empty() && !end.was_run ? 1 : 0;
  const std::size_t failed = failures_of(ends), done = ends.size() - failed;
  console.clear_line();
  if (global.json) {
    Value json = {{"results", options.results()},
                  {"cases", ends.size()},
                  {"done", done},
                  {"known", known},
                  {"failed", failed}};
    std::printf("%s\n", json_text(json, 2).c_str());
  } else if (!global.quiet) {
    std::printf("%zu of %s done, %zu of them before; %zu failed\n", done,
                with_count(std::int64_t(ends.size()), "case").c_str(), known, failed);
  }
}

std::vector<CohortEnd> ends_of(const CohortOptions& options, Cohort& cohort, Console& console) {
  const auto tell = [&](const CohortEnd& end) {
    if (!end.error.empty()) console.error(cohort.name(end.n) + ": " + end.error);
  };
  if (!options.gathers) return cohort.run(options.work, console, tell);
  std::vector<CohortEnd> ends = cohort.gather(console);
  for (const CohortEnd& end : ends) tell(end);
  return ends;
}

int run_cohort(CohortOptions options, const GlobalOptions& global, Console& console) {
  if (!options.shard.empty()) options.work.part = parse_shard(options.shard);
  options.work.threads = global.threads;
  if (global.threads == 0 && options.work.jobs > 1) {
    options.work.threads = std::max(1, thread_limit() / options.work.jobs);
  }
  Cohort cohort(options.scene, options.cases, options.folder);
  console.claim(files_of(options));
  const std::vector<CohortEnd> ends = ends_of(options, cohort, console);
  write_files(options, cohort, ends);
  print_summary(options, ends, global, console);
  return failures_of(ends) == 0 ? kOk : kFailure;
}

}  // namespace

Command add_cohort(CLI::App& program) {
  auto options = std::make_shared<CohortOptions>();
  CLI::App* app = add_subcommand(
      program, "cohort", "Run a scene for each of many cases, each in a process of its own",
      "  supple cohort cases.csv bend.toml -o cohort\n"
      "  supple cohort cases.csv bend.toml -o cohort --shard 2/8 --threads 4\n"
      "  supple cohort cases.csv bend.toml -o cohort --gather");
  app->add_option("cases", options->cases,
                  "A line per case: a column `name`, and keys of the scene with their values, such "
                  "as volume and step[1].by")
      ->required()
      ->option_text("CASES.csv");
  app->add_option("scene", options->scene, "A scene file")->required()->option_text("SCENE.toml");
  app->add_option("-o,--output", options->folder,
                  "Folder of results; cases that are done in it are not run again")
      ->required()
      ->option_text("DIR");
  CLI::Option* shard =
      app->add_option("--shard", options->shard, "Only every N-th case, from the K-th on")
          ->option_text("K/N");
  app->add_option("--jobs", options->work.jobs, "Cases at a time, which share the threads")
      ->check(CLI::Range(1, 1024))
      ->option_text("N");
  CLI::Option* anew =
      app->add_flag("--anew", options->work.anew, "Run all cases again, also those that are done");
  app->add_flag("--gather", options->gathers,
                "Run nothing: make table and page of what is there, as after all shards")
      ->excludes(shard)
      ->excludes(anew);
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_cohort(*options, global, console);
          }};
}

}  // namespace supple::tools
