// Subcommands that the program supple-lab runs; supple declares their options.
#include <cstdio>

#include "tools/console/command.h"
#include "tools/console/program.h"
#include "tools/console/result_lines.h"
#include "tools/lab/options/lab_options.h"
#include "tools/scene/plan/calibrate.h"
#include "tools/scene/plan/unit_costs.h"
#include "volumes/base/json.h"
#include "volumes/base/process.h"

namespace supple::tools {

namespace {

int run_lab(const GlobalOptions& global) {
  const std::string program = program_beside("supple-lab");
  if (program.empty()) {
    throw SystemError(own_program() + "-lab: found no such program, expected the one of bench, " +
                      "stress and tradeoff (target supple-lab)");
  }
  become_program(program, global.arguments);
}

/// Measures and writes the unit costs for the plans of this user's scenes.
int run_calibration(const GlobalOptions& global, Console& console) {
  const std::string path = calibration_file();
  if (path.empty()) {
    throw SystemError("--calibrate: neither XDG_CACHE_HOME nor HOME says where to keep the costs");
  }
  UnitCosts costs = calibrate("supple " + program_version(), console);
  write_costs(path, costs);
  console.note("wrote " + path);
  if (global.json) {
    std::printf("%s\n", json_text(fields_value(costs.fields())).c_str());
  } else if (!global.quiet) {
    for (const Field& field : costs.fields()) {
      const bool is_number = field.holds<double>();
      const std::string value =
          is_number ? number_text(*std::get<double*>(field.target())) : field.text();
      std::printf("%-20s %10s %-3s %s\n", field.name().c_str(), value.c_str(),
                  field.traits().unit.c_str(), field.traits().help.c_str());
    }
  }
  return kOk;
}

/// The subcommand with options that belong to `Given`, which live as long as its action.
template <class Given, class Add>
Command lab_command(CLI::App& program, Add add) {
  auto given = std::make_shared<Given>();
  CLI::App* app = add(program, *given);
  return {app, [given](const GlobalOptions& global, Console&) { return run_lab(global); }};
}

}  // namespace

Command add_bench(CLI::App& program) {
  auto command = std::make_shared<BenchCommand>();
  const BenchApp bench = add_bench_options(program, *command);
  const CLI::Option* const calibrates =
      bench.app
          ->add_flag("--calibrate",
                     "Measure what `supple run --dry-run` reckons with, and keep it for this user")
          ->excludes(bench.name);
  return {bench.app, [command, calibrates](const GlobalOptions& global, Console& console) {
            if (calibrates->count() > 0) return run_calibration(global, console);
            if (command->bench.name.empty()) {
              throw UsageError("bench: found no name, expected one, or --calibrate");
            }
            return run_lab(global);
          }};
}

Command add_stress(CLI::App& program) {
  return lab_command<StressCommand>(program, add_stress_options);
}

Command add_tradeoff(CLI::App& program) {
  return lab_command<TradeCommand>(program, add_tradeoff_options);
}

}  // namespace supple::tools
