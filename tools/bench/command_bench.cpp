// supple bench: times engines on generated bodies and on the head CT, side by side.
#include <cstdio>

#include "tools/bench/bench_ecm.h"
#include "tools/bench/bench_invert.h"
#include "tools/bench/bench_io.h"
#include "tools/bench/bench_relax.h"
#include "tools/bench/bench_render.h"
#include "tools/bench/bench_springs.h"
#include "tools/console/command.h"
#include "tools/outputs/output_plan.h"

namespace supple::tools {

namespace {

struct BenchOptions {
  std::string name, output;
  bool list = false, markdown = false, quick = false;
  std::vector<std::string> only;
  std::string ct_head;
};

/// One benchmark under the options that all share.
struct Bench {
  std::function<std::vector<std::string>()> row_names;
  std::function<BenchReport()> measure;
};

Bench bench_of(const BenchOptions& options, int threads, Console& console) {
  if (options.name == "invert") {
    const InvertBenchOptions invert{options.quick, threads, options.only};
    return {[=] { return invert_row_names(invert); },
            [=, &console] { return bench_invert(invert, console); }};
  }
  if (options.name == "io") {
    const IoBenchOptions io{options.quick, threads, options.only};
    return {[=] { return io_row_names(io); }, [=, &console] { return bench_io(io, console); }};
  }
  if (options.name == "relax") {
    const RelaxBenchOptions relax{options.quick, threads, options.only, options.ct_head};
    return {[=, &console] { return relax_row_names(relax, console); },
            [=, &console] { return bench_relax(relax, console); }};
  }
  if (options.name == "render") {
    const RenderBenchOptions render{options.quick, threads, options.only};
    return {[=] { return render_row_names(render); },
            [=, &console] { return bench_render(render, console); }};
  }
  if (options.name == "springs") {
    const SpringsBenchOptions springs{options.quick, options.only};
    return {[=] { return springs_row_names(springs); },
            [=, &console] { return bench_springs(springs, console); }};
  }
  const EcmBenchOptions ecm{options.quick, threads, options.only, options.ct_head};
  return {[=, &console] { return ecm_row_names(ecm, console); },
          [=, &console] { return bench_ecm(ecm, console); }};
}

int run_bench(BenchOptions& options, const GlobalOptions& global, Console& console) {
  const Bench bench = bench_of(options, global.threads, console);
  if (options.list) {
    for (const std::string& name : bench.row_names()) std::printf("%s\n", name.c_str());
    return kOk;
  }
  OutputPlan plan(global);
  if (!options.output.empty()) plan.add_report(options.output);
  const BenchReport report = bench.measure();
  if (!options.output.empty()) write_json(options.output, report);
  if (global.json) {
    std::printf("%s\n", to_json(report).dump(2).c_str());
  } else if (!global.quiet) {
    std::fputs((options.markdown ? to_markdown(report) : to_text(report)).c_str(), stdout);
  }
  return kOk;
}

}  // namespace

Command add_bench(CLI::App& program) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* app =
      add_subcommand(program, "bench", "Time the engines side by side and say what they hold",
                     "  supple bench ecm --quick\n"
                     "  supple bench ecm --only 'all/noise/128*+x/rest' --json ecm.json\n"
                     "  supple bench invert --only 128 --json invert.json");
  app->add_option("name", options->name,
                  "Which benchmark: ecm, invert, io, relax, render or springs")
      ->required()
      ->check(CLI::IsMember({"ecm", "invert", "io", "relax", "render", "springs"}))
      ->option_text("NAME");
  app->add_flag("--quick", options->quick, "The rows that matter most, within a minute");
  app->add_option("--only", options->only,
                  "Rows whose name holds this; * stands for anything; may be repeated")
      ->allow_extra_args(false)
      ->option_text("PATTERN");
  CLI::Option* list =
      app->add_flag("--list", options->list, "Print the names of the rows and measure none");
  app->add_option("--json", options->output, "Write the rows as JSON")
      ->excludes(list)
      ->option_text("FILE");
  app->add_flag("--markdown", options->markdown, "Print tables of a Markdown document")
      ->excludes(list);
  app->add_option("--ct-head", options->ct_head,
                  "The head CT of ecm and relax; build/data/ct_head.nhdr where that exists")
      ->option_text("FILE");
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_bench(*options, global, console);
          }};
}

}  // namespace supple::tools
