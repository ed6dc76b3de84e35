// supple bench: times engines on generated bodies and on the head CT, side by side.
#include <cstdio>

#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/lab/bench/benches.h"
#include "tools/scene/run/output_plan.h"

namespace supple::tools {

namespace {

struct CommandOptions {
  BenchOptions bench;
  std::string output;
  bool list = false, markdown = false, calibrate = false;
};

Fields fields(CommandOptions& options) {
  return {
      Field("quick", options.bench.quick, "The rows that matter most, within a minute"),
      Field("only", options.bench.only,
            "Rows whose name holds this; * stands for anything; may be repeated")
          .shown_as("PATTERN"),
      Field("list", options.list, "Print the names of the rows and measure none"),
      Field("json", options.output, "Write the rows as JSON").shown_as("FILE"),
      Field("markdown", options.markdown, "Print tables of a Markdown document"),
      Field("ct_head", options.bench.ct_head, "The head CT of ecm, fem and relax")
          .shown_as("FILE")
          .otherwise("build/data/ct_head.nhdr where that exists"),
  };
}

/// For the plans of this user's scenes.
int run_calibration(const GlobalOptions& global, Console& console) {
  const std::string path = calibration_file();
  if (path.empty()) {
    throw SystemError("--calibrate: neither XDG_CACHE_HOME nor HOME says where to keep the costs");
  }
  UnitCosts costs = measured_costs(console);
  write_costs(path, costs);
  console.note("wrote " + path);
  if (global.json) {
    std::printf("%s\n", fields_json(fields(costs)).c_str());
  } else if (!global.quiet) {
    for (const Field& field : fields(costs)) {
      const bool is_number = field.holds<double>();
      const std::string value =
          is_number ? number_text(*std::get<double*>(field.target())) : field.text();
      std::printf("%-20s %10s %-3s %s\n", field.name().c_str(), value.c_str(), field.unit().c_str(),
                  field.help().c_str());
    }
  }
  return kOk;
}

int run_bench(const CommandOptions& options, const GlobalOptions& global, Console& console) {
  if (options.calibrate) return run_calibration(global, console);
  if (options.bench.name.empty())
    throw UsageError("bench: found no name, expected one, or --calibrate");
  if (options.list && (options.markdown || !options.output.empty())) {
    throw UsageError("--list: found beside --json or --markdown, expected one of them");
  }
  const Bench bench = bench_of(options.bench, global.threads, console);
  if (options.list) {
    for (const std::string& name : bench.row_names()) std::printf("%s\n", name.c_str());
    return kOk;
  }
  OutputPlan plan(global.force);
  if (!options.output.empty()) plan.add_report(options.output);
  console.claim(plan.files());
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
  auto options = std::make_shared<CommandOptions>();
  CLI::App* app =
      add_subcommand(program, "bench", "Time the engines side by side and say what they hold",
                     "  supple bench ecm --quick\n"
                     "  supple bench ecm --only 'all/noise/128*+x/rest' --json ecm.json\n"
                     "  supple bench invert --only 128 --json invert.json");
  CLI::Option* name =
      app->add_option(
             "name", options->bench.name,
             "Which benchmark: ecm, economy, fem, fit, invert, io, relax, render or springs")
          ->check(CLI::IsMember(
              {"ecm", "economy", "fem", "fit", "invert", "io", "relax", "render", "springs"}))
          ->option_text("NAME");
  app->add_flag("--calibrate", options->calibrate,
                "Measure what `supple run --dry-run` reckons with, and keep it for this user")
      ->excludes(name);
  add_field_options(*app, fields(*options));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_bench(*options, global, console);
          }};
}

}  // namespace supple::tools
