// Subcommands of supple-lab.
#pragma once

#include "tools/console/command.h"

namespace supple::tools {

Command bench_command(CLI::App& program);
Command stress_command(CLI::App& program);
Command tradeoff_command(CLI::App& program);

}  // namespace supple::tools
