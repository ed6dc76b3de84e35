// Every model under extremes, each row with what is expected and what was measured.
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "tools/lab/commands/lab_commands.h"
#include "tools/lab/stress/stress_table.h"
#include "tools/scene/run/output_plan.h"
#include "volumes/base/files.h"

namespace supple::tools {

namespace {

bool has_extension(const std::string& path, const char* extension) {
  return std::filesystem::path(path).extension() == extension;
}

/// Claims the outputs before the first row.
void claim_outputs(const std::vector<std::string>& outputs, const GlobalOptions& global,
                   Console& console) {
  OutputPlan plan(global.force);
  for (const std::string& path : outputs) {
    if (!has_extension(path, ".md") && !has_extension(path, ".csv")) {
      const std::string extension = std::filesystem::path(path).extension().string();
      throw UsageError(to_line(
          {path, "--output", extension.empty() ? "no extension" : extension, ".md or .csv"}));
    }
  }
  plan.add_files(outputs);
  console.claim(plan.files());
}

/// Runs one row for a program that runs all: prints its measured values alone, on stdout.
int run_one(const StressCommand& given, Console& console) {
  const StressCell cell = stress_cell_named(given.row);
  if (given.options.folder.empty()) throw UsageError("--row: needs --keep, a folder for its files");
  std::filesystem::create_directories(given.options.folder);
  const MeasuredValues measured = run_row(cell, given.options.folder, console);
  std::printf("%s\n", to_json(measured).dump(2).c_str());
  return kOk;
}

void print_end(const std::vector<StressRow>& rows, std::size_t disagreeing) {
  std::printf("%zu of %zu rows agree\n", rows.size() - disagreeing, rows.size());
}

int run_all(const StressCommand& given, const GlobalOptions& global, Console& console) {
  claim_outputs(given.outputs, global, console);
  StressOptions options = given.options;
  options.threads = global.threads;
  const bool prints = !global.json && !global.quiet;
  const std::vector<StressRow> rows = run_stress(options, console, [&](const StressRow& row) {
    if (!prints) return;
    console.clear_line();
    std::fputs(row_text(row).c_str(), stdout);
    std::fflush(stdout);
  });
  for (const std::string& path : given.outputs) {
    replace_text_file(path, has_extension(path, ".md") ? to_markdown(rows) : to_csv(rows));
  }
  const auto disagreeing = std::size_t(
      std::count_if(rows.begin(), rows.end(), [](const StressRow& row) { return !row.agrees; }));
  if (global.json) std::printf("%s\n", to_json(rows).dump(2).c_str());
  if (prints) print_end(rows, disagreeing);
  return disagreeing == 0 ? kOk : kFailure;
}

int run_stress_command(const StressCommand& given, const GlobalOptions& global, Console& console) {
  if (!given.row.empty()) return run_one(given, console);
  if (!given.markdown.empty()) {
    std::fputs((given.markdown == "models" ? models_markdown() : extremes_markdown()).c_str(),
               stdout);
    return kOk;
  }
  if (given.lists) {
    std::fputs(cells_text(cells_of(given.options.choice)).c_str(), stdout);
    return kOk;
  }
  return run_all(given, global, console);
}

}  // namespace

Command stress_command(CLI::App& program) {
  auto given = std::make_shared<StressCommand>();
  CLI::App* app = add_stress_options(program, *given);
  return {app, [given](const GlobalOptions& global, Console& console) {
            return run_stress_command(*given, global, console);
          }};
}

}  // namespace supple::tools
