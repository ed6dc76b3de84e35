// supple help: the help of a command; the manual page and shell completion of the whole program.
#include <cstdio>

#include "tools/console/command.h"
#include "tools/console/help.h"
#include "tools/console/manual.h"

namespace supple::tools {

namespace {

struct HelpOptions {
  std::string command;
  bool manual = false;
  CLI::Option* completes = nullptr;
  std::string shell = "bash";
};

std::string completion_for(const std::string& shell, const CLI::App& program) {
  if (shell == "zsh") return zsh_completion(program);
  return shell == "fish" ? fish_completion(program) : bash_completion(program);
}

int run_help(const HelpOptions& options, const CLI::App& program) {
  if (options.manual) {
    std::fputs(manual_page(program).c_str(), stdout);
    return kOk;
  }
  if (options.completes->count() > 0) {
    std::fputs(completion_for(options.shell, program).c_str(), stdout);
    return kOk;
  }
  if (options.command.empty()) {
    // App::help() would be that of the command that was given, this one.
    const std::string text = program.get_formatter()->make_help(&program, program.get_name(),
                                                                CLI::AppFormatMode::Normal);
    std::fputs(text.c_str(), stdout);
    return kOk;
  }
  const CLI::App* command = find_command(program, options.command);
  if (command == nullptr) throw UsageError(unknown_subcommand(program, options.command));
  std::fputs(command->help(program.get_name()).c_str(), stdout);
  return kOk;
}

}  // namespace

Command add_help(CLI::App& program) {
  auto options = std::make_shared<HelpOptions>();
  CLI::App* app = add_subcommand(program, "help", "Print the help of a command",
                                 "  supple help deform\n"
                                 "  supple help --manual > supple.1\n"
                                 "  supple help --completion zsh > _supple");
  app->add_option("command", options->command, "Whose help")->option_text("COMMAND");
  CLI::Option* manual =
      app->add_flag("--manual", options->manual, "Print the manual page, for man -l");
  options->completes =
      app->add_option("--completion", options->shell,
                      "Print a script that completes words in a shell (bash where none is named)")
          ->option_text("bash|zsh|fish")
          ->expected(0, 1)
          ->default_str("bash")
          ->check(CLI::IsMember({"bash", "zsh", "fish"}))
          ->excludes(manual);
  return {app, [options, &program](const GlobalOptions&, Console&) {
            return run_help(*options, program);
          }};
}

}  // namespace supple::tools
