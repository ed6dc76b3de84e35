// Another run of this program: what it says on stdout, how it ended, and within which time.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace supple::tools {

struct ChildEnd {
  int exit_code = -1;      // -1: ended by a signal
  bool timed_out = false;  // it was ended when its time was over
  std::string out;         // stdout
  std::string complaint;   // the last line on stderr, without "supple: error: "
  std::string warnings;    // all lines of warnings, likewise, joined by "; "
  double wall_s = 0;       // from its start to its end
};

/// Runs the program with these arguments until it ends, or ends it after `limit_s`, or when
/// `cancelled` says so, which is asked every 50 ms; throws Cancelled then. It never outlives this
/// process. Throws SystemError where it cannot be started.
ChildEnd run_child(const std::string& program, const std::vector<std::string>& arguments,
                   double limit_s, const std::function<bool()>& cancelled);

}  // namespace supple::tools
