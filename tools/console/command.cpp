#include "tools/console/command.h"

namespace supple::tools {

CLI::App* add_subcommand(CLI::App& program, const std::string& name, const std::string& description,
                         const std::string& examples) {
  CLI::App* app = program.add_subcommand(name, description);
  app->footer("Examples:\n" + examples);
  return app;
}

void add_grid_options(CLI::App& app, std::string& file, double& margin_mm) {
  app.add_option("--grid", file, "Take the output grid from this volume")->option_text("FILE");
  app.add_option("--margin", margin_mm, "Grow the grid on every side, in mm")->option_text("MM");
}

void add_offset_option(CLI::App& app, std::string& file) {
  app.add_option("--offset", file, "Bend, twist, taper, cut open, explode … (docs/scenes.md)")
      ->option_text("FILE.toml");
}

void require_within(const std::string& option, double value, double lo, double hi) {
  if (value >= lo && value <= hi) return;
  throw InputError({"", option, number_text(value), number_text(lo) + " to " + number_text(hi)});
}

}  // namespace supple::tools
