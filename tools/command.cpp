#include "tools/command.h"

#include <filesystem>

namespace supple::tools {

CLI::App* add_subcommand(CLI::App& program, const std::string& name, const std::string& description,
                         const std::string& examples) {
  CLI::App* app = program.add_subcommand(name, description);
  app->footer("Examples:\n" + examples);
  return app;
}

void check_output(const std::string& path, const GlobalOptions& options) {
  const std::filesystem::path file(path);
  if (std::filesystem::is_directory(file)) {
    throw InputError({path, "output", "a directory", "a file name"});
  }
  if (!options.force && std::filesystem::exists(file)) {
    throw UsageError(path + ": output exists, add --force to overwrite it");
  }
  const std::filesystem::path folder = file.parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder)) {
    throw InputError({path, "output folder", "no such folder", "an existing folder"});
  }
}

}  // namespace supple::tools
