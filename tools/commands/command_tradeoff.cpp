// supple tradeoff: time against error of every model on one load.
#include <cstdio>

#include <nlohmann/json.hpp>

#include "tools/console/command.h"
#include "tools/lab/tradeoff/page/scene_charts.h"
#include "tools/lab/tradeoff/page/trade_page.h"
#include "volumes/base/text_file.h"

namespace supple::tools {

namespace {

struct TradeCommand {
  TradeOptions options;
  std::vector<std::string> methods, drawings;
  bool has_drawings = true;
};

int run_trade(const TradeCommand& given, const GlobalOptions& global, Console& console) {
  TradeOptions options = given.options;
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

Command add_tradeoff(CLI::App& program) {
  auto given = std::make_shared<TradeCommand>();
  TradeOptions& options = given->options;
  CLI::App* app = add_subcommand(program, "tradeoff",
                                 "Time against error of every model on the load of a scene",
                                 "  supple tradeoff press.toml -o out/press\n"
                                 "  supple tradeoff press.toml -o out/press --method fem "
                                 "--method relax-26:64 --runs 3\n"
                                 "  supple tradeoff a.toml b.toml --held-out c.toml -o out/loads");
  app->add_option("scene", options.scenes, "Scene files, one load each")
      ->required()
      ->option_text("SCENE.toml");
  app->add_option("-o,--output", options.measure.folder,
                  "Folder of the results; what it holds is kept")
      ->required()
      ->option_text("DIR");
  app->add_option("--held-out", options.held_out,
                  "One more load: measured and drawn, but nothing is chosen by it")
      ->option_text("SCENE.toml");
  app->add_option("--method", given->methods, "Of all methods these, such as fem or relax-26:64")
      ->option_text("NAME[:KNOB]");
  app->add_option("--drawing", given->drawings, "Of all drawings these, such as draw-newton")
      ->option_text("NAME[:KNOB]");
  app->add_flag("!--no-drawings", given->has_drawings, "Leave drawings out");
  app->add_option("--runs", options.measure.runs, "Times that a row is measured")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str()
      ->option_text("N");
  app->add_option("--limit", options.measure.limit_s, "Seconds after which a run is ended")
      ->check(CLI::Range(0.01, 1e6))
      ->capture_default_str()
      ->option_text("S");
  app->add_option("--row-time", options.measure.row_s,
                  "No further run of a row after so many seconds")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str()
      ->option_text("S");
  return {app, [given](const GlobalOptions& global, Console& console) {
            return run_trade(*given, global, console);
          }};
}

}  // namespace supple::tools
