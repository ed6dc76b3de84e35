// Another program: what it says, how it ended, and within which time and memory.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace supple {

/// A program that takes more is ended. Its memory is looked at every 50 ms.
struct ProgramLimits {
  double wall_s = std::numeric_limits<double>::infinity();
  double resident_mb = std::numeric_limits<double>::infinity();  // millions of bytes
};

struct ProgramEnd {
  int exit_code = -1;        // -1: ended by a signal
  int signal = 0;            // that one
  bool timed_out = false;    // it was ended when its time was over
  bool over_memory = false;  // it was ended when it held more than its limit
  std::string out, err;      // stdout and stderr
  double wall_s = 0;         // from its start to its end
  double peak_mb = 0;        // the largest resident size that was seen, in millions of bytes
};

/// Exit code of a program that is not there or cannot be started, as a shell has it.
constexpr int kNoSuchProgram = 127;

/// Runs a program, which is looked for on the PATH unless its name has a slash, in `folder` (empty:
/// the present one) until it ends, or ends it at its limits, or when `cancelled` says so, which is
/// asked every 50 ms; throws Cancelled then, when the program has removed its files or half a
/// second has passed. It never outlives this process. Throws SystemError where no process can be
/// started.
ProgramEnd run_program(const std::string& program, const std::vector<std::string>& arguments,
                       const std::string& folder, const ProgramLimits& limits,
                       const std::function<bool()>& cancelled);

}  // namespace supple
