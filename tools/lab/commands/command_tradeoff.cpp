// Time against error of every model on one load.
#include <cstdio>

#include <nlohmann/json.hpp>

#include "tools/lab/commands/lab_commands.h"
#include "tools/lab/tradeoff/page/trade_page.h"
#include "volumes/base/files.h"

namespace supple::tools {

namespace {

int run_trade(const TradeCommand& given, const GlobalOptions& global, Console& console) {
  TradeOptions options;
  options.scenes = given.scenes;
  options.held_out = given.held_out;
  options.measure = given.measure;
  options.measure.threads = global.threads;
  options.methods = settings_named(given.methods, method_families(), "method");
  if (given.has_drawings) {
    options.drawings = settings_named(given.drawings, draw_families(), "drawing");
  }
  const TradeResults results = run_tradeoff(options, console);
  const nlohmann::ordered_json json = to_json(results);
  replace_text_file(options.measure.folder + "/tradeoff.json", json.dump(2) + '\n');
  replace_text_file(options.measure.folder + "/index.html", trade_page(results));
  for (const ChartFile& chart : chart_files(results)) {
    replace_text_file(options.measure.folder + '/' + chart.name, chart.svg);
  }
  if (json.contains("held_out")) console.note(json["held_out"]["summary"]);
  if (global.json) {
    std::printf("%s\n", json.dump(2).c_str());
  } else if (!global.quiet) {
    std::printf("%s\n", (options.measure.folder + "/index.html").c_str());
  }
  return kOk;
}

}  // namespace

Command tradeoff_command(CLI::App& program) {
  auto given = std::make_shared<TradeCommand>();
  CLI::App* app = add_tradeoff_options(program, *given);
  return {app, [given](const GlobalOptions& global, Console& console) {
            return run_trade(*given, global, console);
          }};
}

}  // namespace supple::tools
