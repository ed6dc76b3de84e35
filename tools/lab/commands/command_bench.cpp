// Times engines on generated bodies and on the head CT, side by side.
#include <cstdio>

#include "tools/lab/bench/benches.h"
#include "tools/lab/commands/lab_commands.h"
#include "tools/scene/run/output_plan.h"

namespace supple::tools {

namespace {

int run_bench(const BenchCommand& command, const GlobalOptions& global, Console& console) {
  if (command.list && (command.markdown || !command.output.empty())) {
    throw UsageError("--list: found beside --json or --markdown, expected one of them");
  }
  BenchOptions options = command.bench;
  options.threads = global.threads;
  const Bench& bench = bench_named(options.name);
  if (command.list) {
    for (const std::string& name : bench.row_names(options, console))
      std::printf("%s\n", name.c_str());
    return kOk;
  }
  OutputPlan plan(global.force);
  if (!command.output.empty()) plan.add_report(command.output);
  console.claim(plan.files());
  const BenchReport report = bench.measure(options, console);
  if (!command.output.empty()) write_json(command.output, report);
  if (global.json) {
    std::printf("%s\n", to_json(report).dump(2).c_str());
  } else if (!global.quiet) {
    std::fputs((command.markdown ? to_markdown(report) : to_text(report)).c_str(), stdout);
  }
  return kOk;
}

}  // namespace

Command bench_command(CLI::App& program) {
  auto command = std::make_shared<BenchCommand>();
  const BenchApp bench = add_bench_options(program, *command);
  bench.name->required();
  return {bench.app, [command](const GlobalOptions& global, Console& console) {
            return run_bench(*command, global, console);
          }};
}

}  // namespace supple::tools
