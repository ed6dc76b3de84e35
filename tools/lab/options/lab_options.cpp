#include "tools/lab/options/lab_options.h"

#include "tools/console/command.h"
#include "tools/console/field_options.h"

namespace supple::tools {

namespace {

Fields fields(BenchCommand& command) {
  return {
      Field("quick", command.bench.quick, "The rows that matter most, within a minute"),
      Field("only", command.bench.only,
            "Rows whose name holds this; * stands for anything; may be repeated")
          .shown_as("PATTERN"),
      Field("list", command.list, "Print the names of the rows and measure none"),
      Field("json", command.output, "Write the rows as JSON").shown_as("FILE"),
      Field("markdown", command.markdown, "Print tables of a Markdown document"),
      Field("ct_head", command.bench.ct_head, "The head CT of ecm, fem and relax")
          .shown_as("FILE")
          .otherwise("build/data/ct_head.nhdr where that exists"),
  };
}

}  // namespace

BenchApp add_bench_options(CLI::App& program, BenchCommand& command) {
  CLI::App* app =
      add_subcommand(program, "bench", "Time the engines side by side and say what they hold",
                     "  supple bench ecm --quick\n"
                     "  supple bench ecm --only 'all/noise/128*+x/rest' --json ecm.json\n"
                     "  supple bench invert --only 128 --json invert.json");
  CLI::Option* name = app->add_option("name", command.bench.name,
                                      "Which benchmark: ecm, economy, fem, fit, invert, io, "
                                      "membrane, mesh, relax, render or "
                                      "springs")
                          ->check(CLI::IsMember({"ecm", "economy", "fem", "fit", "invert", "io",
                                                 "membrane", "mesh", "relax", "render", "springs"}))
                          ->option_text("NAME");
  add_field_options(*app, fields(command));
  return {app, name};
}

CLI::App* add_stress_options(CLI::App& program, StressCommand& given) {
  StressOptions& options = given.options;
  CLI::App* app = add_subcommand(program, "stress",
                                 "Every model under extremes: finite and bounded, or refused",
                                 "  supple stress\n"
                                 "  supple stress --only fem --only far-drag\n"
                                 "  supple stress --long -o stress.md -o stress.csv");
  app->add_option("--only", options.choice.only, "Of the matrix an extreme, a model or one row")
      ->option_text("EXTREME|MODEL|EXTREME/MODEL");
  app->add_flag("--quick", options.choice.quick, "Of every extreme one model");
  app->add_flag("--long", options.choice.with_long,
                "Also rows of minutes and gigabytes, such as a million islands");
  app->add_flag("--list", given.lists, "What is expected of every row; nothing runs");
  app->add_option("--markdown", given.markdown, "The matrix as the tables of docs/extremes.md")
      ->check(CLI::IsMember({"models", "extremes"}))
      ->option_text("models|extremes");
  app->add_option("-o,--output", given.outputs, "Table of the results, may be given several times")
      ->option_text("F.md|F.csv");
  app->add_option("--keep", options.folder, "Keep input and results of every row here")
      ->option_text("DIR");
  app->add_option("--patience", options.patience,
                  "Multiplies the limits of time and memory, as for a build with sanitizers")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str()
      ->option_text("FACTOR");
  app->add_option("--row", given.row, "One row in this process, as for a debugger; needs --keep")
      ->option_text("EXTREME/MODEL");
  return app;
}

CLI::App* add_tradeoff_options(CLI::App& program, TradeCommand& given) {
  CLI::App* app = add_subcommand(program, "tradeoff",
                                 "Time against error of every model on the load of a scene",
                                 "  supple tradeoff press.toml -o out/press\n"
                                 "  supple tradeoff press.toml -o out/press --method fem "
                                 "--method relax-26:64 --runs 3\n"
                                 "  supple tradeoff a.toml b.toml --held-out c.toml -o out/loads");
  app->add_option("scene", given.scenes, "Scene files, one load each")
      ->required()
      ->option_text("SCENE.toml");
  app->add_option("-o,--output", given.measure.folder,
                  "Folder of the results; what it holds is kept")
      ->required()
      ->option_text("DIR");
  app->add_option("--held-out", given.held_out,
                  "One more load: measured and drawn, but nothing is chosen by it")
      ->option_text("SCENE.toml");
  app->add_option("--method", given.methods, "Of all methods these, such as fem or relax-26:64")
      ->option_text("NAME[:KNOB]");
  app->add_option("--drawing", given.drawings, "Of all drawings these, such as draw-newton")
      ->option_text("NAME[:KNOB]");
  app->add_flag("!--no-drawings", given.has_drawings, "Leave drawings out");
  app->add_option("--runs", given.measure.runs, "Times that a row is measured")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str()
      ->option_text("N");
  app->add_option("--limit", given.measure.limit_s, "Seconds after which a run is ended")
      ->check(CLI::Range(0.01, 1e6))
      ->capture_default_str()
      ->option_text("S");
  app->add_option("--row-time", given.measure.row_s,
                  "No further run of a row after so many seconds")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str()
      ->option_text("S");
  return app;
}

}  // namespace supple::tools
