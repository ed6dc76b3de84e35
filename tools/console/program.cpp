#include "tools/console/program.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <new>

#include <sys/mman.h>

#include "tools/console/build_facts.h"
#include "tools/console/help.h"
#include "volumes/base/memory.h"
#include "volumes/base/parallel.h"
#include "volumes/base/process.h"
#include "volumes/base/signals.h"
#include "volumes/base/version.h"

namespace supple::tools {

namespace {

const std::map<std::string, LogLevel> kLevels = {{"error", LogLevel::error},
                                                 {"warning", LogLevel::warning},
                                                 {"info", LogLevel::info},
                                                 {"debug", LogLevel::debug}};

void add_global_options(CLI::App& program, GlobalOptions& options) {
  const auto group = kEverywhere;
  program.add_option("--threads", options.threads, "Number of threads, 0 for all")
      ->check(CLI::Range(0, 1024))
      ->option_text("N")
      ->group(group);
  program.add_flag("--quiet", options.quiet, "No progress, notes or warnings")->group(group);
  program.add_flag("--json", options.json, "Results as one JSON object on stdout")->group(group);
  program.add_flag("--force", options.force, "Overwrite existing outputs")->group(group);
  program
      .add_option_function<std::string>(
          "--log-level",
          [&options](const std::string& name) { options.log_level = kLevels.at(name); },
          "error, warning, info or debug")
      ->check(CLI::IsMember({"error", "warning", "info", "debug"}))
      ->option_text("LEVEL")
      ->group(group);
}

/// Prints one line on stderr, whatever the message holds.
int fail(int exit_code, const std::string& message) {
  std::fprintf(stderr, "supple: error: %s\n", one_line(message).c_str());
  return exit_code;
}

/// Addresses given back when memory runs out, since destructors of libraries allocate, too. They
/// lie apart from the heap, so that threads and allocators of libraries find them.
constexpr std::size_t kReserveBytes = std::size_t(32) << 20;
std::atomic<void*> g_reserve{nullptr};  // threads may run out at the same time

void release_reserve() {
  if (void* const reserve = g_reserve.exchange(nullptr)) ::munmap(reserve, kReserveBytes);
  throw std::bad_alloc();
}

/// Throws std::bad_alloc. Untouched the reserve takes addresses only.
void keep_reserve() {
  void* const reserve = ::mmap(nullptr, kReserveBytes, PROT_READ | PROT_WRITE,
                               MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (reserve == MAP_FAILED) throw std::bad_alloc();
  g_reserve = reserve;
  std::set_new_handler(release_reserve);
}

/// Options by their former names are not shown, but read.
void warn_of_former_options(const CLI::App& app, Console& console) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty() && option->count() > 0) {
      console.warn("--" + option->get_lnames().front() + ": " + option->get_description());
    }
  }
}

/// A choice among what a file holds, by its option: "frame 0 to 2" is --frame 0 to 2.
Problem with_choice_named(Problem problem, const CLI::App& app) {
  for (const char* const name : {"frame", "channel"}) {
    const std::string option = std::string("--") + name;
    if (app.get_option_no_throw(option) == nullptr) continue;
    if (problem.field == name) problem.field = option;
    const std::size_t at = problem.expected.find(std::string(name) + " 0");
    if (at != std::string::npos) problem.expected.insert(at, "--");
  }
  return problem;
}

/// The problem with the option of the command in place of the field that it sets.
std::string named_by_option(const Problem& problem, const CLI::App& app) {
  if (!problem.file.empty()) return to_line(with_choice_named(problem, app));
  std::string name = "--" + problem.field;
  std::replace(name.begin(), name.end(), '_', '-');
  for (const std::string& option : {name, "--no-" + name.substr(2)}) {
    if (app.get_option_no_throw(option) == nullptr) continue;
    return to_line({"", option, problem.found, problem.expected});
  }
  return to_line(problem);
}

/// Results are kept until the progress line of a terminal is gone.
int run_command(const Command& command, const GlobalOptions& options) {
  try {
    Console console(options);
    warn_of_former_options(*command.app, console);
    std::setvbuf(stdout, nullptr, _IOFBF, std::size_t(1) << 16);
    const auto run = [&] { return command.run(options, console); };
    const int exit_code = options.threads > 0 ? on_threads(options.threads, run) : run();
    console.tell_outputs();
    console.clear_line();
    if (std::fflush(stdout) != 0) throw SystemError("standard output: cannot write");
    return exit_code;
  } catch (const UsageError& error) {
    return fail(kUsage, error.what());
  } catch (const InputError& error) {
    return fail(kBadInput, named_by_option(error.problem(), *command.app));
  } catch (const SystemError& error) {
    return fail(kSystem, error.what());
  } catch (const Cancelled&) {
    return end_by_signal();
  } catch (const std::bad_alloc&) {
    return fail(kSystem, command.app->get_name() + ": not enough memory");
  } catch (const std::filesystem::filesystem_error& error) {
    const std::string place = error.path1().string();
    return fail(kSystem, (place.empty() ? "" : place + ": ") + error.code().message());
  } catch (const std::exception& error) {
    // TBB says so of a thread whose stack finds no room.
    if (std::string(error.what()).find("pthread_create") != std::string::npos) {
      return fail(kSystem, command.app->get_name() + ": not enough memory for threads");
    }
    return fail(kFailure, error.what());
  }
}

std::vector<Command> commands_of(CLI::App& app, const ProgramParts& parts) {
  std::vector<Command> commands;
  for (Command (*const add)(CLI::App&) : parts.commands) commands.push_back(add(app));
  return commands;
}

int parse_and_run(int argc, char** argv, const ProgramParts& parts) {
  GlobalOptions options;
  options.arguments.assign(argv, argv + argc);
  CLI::App program(parts.purpose, "supple");
  program.set_version_flag("-V,--version", "supple " + program_version() + "\n  " + kLibraries);
  program.require_subcommand(1);
  program.fallthrough();
  program.formatter(std::make_shared<WrappingFormatter>());
  add_global_options(program, options);
  program.footer(parts.footer);
  const std::vector<Command> commands = commands_of(program, parts);
  const auto is_named = [&](const Command& command) { return command.app->check_name(argv[1]); };
  if (argc > 1 && argv[1][0] != '-' && std::none_of(commands.begin(), commands.end(), is_named)) {
    return fail(kUsage, unknown_subcommand(program, argv[1]));
  }
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);
    const std::string hint = hint_for(program, {argv + 1, argv + argc});
    const bool names_command = argc > 1 && argv[1][0] != '-';
    const std::string help = names_command ? "supple " + std::string(argv[1]) : "supple";
    return fail(kUsage, hint.empty() ? error.what() + (" (see " + help + " --help)") : hint);
  } catch (const UsageError& error) {
    return fail(kUsage, error.what());
  } catch (const InputError& error) {
    return fail(kBadInput, error.what());
  }
  install_signal_handlers();
  allow_child_processes(true);
  keep_reserve();
  for (const Command& command : commands) {
    if (command.app->parsed()) return run_command(command, options);
  }
  return kUsage;
}

}  // namespace

int run_program(int argc, char** argv, const ProgramParts& parts) {
  keep_heap_in_large_pages();
  try {
    return parse_and_run(argc, argv, parts);
  } catch (const std::bad_alloc&) {
    std::fputs("supple: error: not enough memory\n", stderr);  // which allocates nothing
    return kSystem;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "supple: error: %s\n", error.what());
    return kFailure;
  }
}

std::string program_version() {
  return std::string(kVersion) + ", commit " + kCommit;
}

}  // namespace supple::tools
