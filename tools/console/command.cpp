#include "tools/console/command.h"

namespace supple::tools {

CLI::App* add_subcommand(CLI::App& program, const std::string& name, const std::string& description,
                         const std::string& examples) {
  CLI::App* app = program.add_subcommand(name, description);
  app->footer("Examples:\n" + examples);
  return app;
}

void require_within(const std::string& option, double value, double lo, double hi) {
  if (value >= lo && value <= hi) return;
  throw InputError({"", option, number_text(value), number_text(lo) + " to " + number_text(hi)});
}

}  // namespace supple::tools
