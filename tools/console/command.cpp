#include "tools/console/command.h"

namespace supple::tools {

CLI::App* add_subcommand(CLI::App& program, const std::string& name, const std::string& description,
                         const std::string& examples) {
  CLI::App* app = program.add_subcommand(name, description);
  app->footer("Examples:\n" + examples);
  return app;
}

}  // namespace supple::tools
