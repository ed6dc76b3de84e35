#include "tools/command.h"

#include <filesystem>

#include "volumes/base/atomic_file.h"

namespace supple::tools {

CLI::App* add_subcommand(CLI::App& program, const std::string& name, const std::string& description,
                         const std::string& examples) {
  CLI::App* app = program.add_subcommand(name, description);
  app->footer("Examples:\n" + examples);
  return app;
}

void check_output(const std::string& path, const GlobalOptions& options) {
  check_output_place(path);
  if (!options.force && std::filesystem::exists(path)) {
    throw UsageError(path + ": output exists, add --force to overwrite it");
  }
}

}  // namespace supple::tools
