// The main function of a program with subcommands, and which program it is.
#pragma once

#include <string>
#include <vector>

#include "tools/console/command.h"

namespace supple::tools {

/// The differences between programs: what their help says, and their subcommands.
struct ProgramParts {
  std::string purpose, footer;
  std::vector<Command (*)(CLI::App&)> commands;
};

/// Parses the command line, runs one subcommand and turns errors into exit codes.
int run_program(int argc, char** argv, const ProgramParts& parts);

/// "1.2.3, commit abc".
std::string program_version();

}  // namespace supple::tools
