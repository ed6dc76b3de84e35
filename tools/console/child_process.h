// Another run of this program: what it says on stdout, how it ended, and within which time and
// memory.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace supple::tools {

/// A child that takes more is ended. Its memory is looked at every 50 ms.
struct ChildLimits {
  double wall_s = std::numeric_limits<double>::infinity();
  double resident_mb = std::numeric_limits<double>::infinity();  // millions of bytes
};

struct ChildEnd {
  int exit_code = -1;        // -1: ended by a signal
  bool timed_out = false;    // it was ended when its time was over
  bool over_memory = false;  // it was ended when it held more than its limit
  std::string out;           // stdout
  /// The last error on stderr, without "supple: error: "; where there is none the report of a
  /// sanitizer, or the last line.
  std::string complaint;
  std::string warnings;  // all lines of warnings, likewise, joined by "; "
  double wall_s = 0;     // from its start to its end
  double peak_mb = 0;    // the largest resident size that was seen, in millions of bytes
};

/// Runs the program with these arguments until it ends, or ends it at its limits, or when
/// `cancelled` says so, which is asked every 50 ms; throws Cancelled then. It never outlives this
/// process. Throws SystemError where it cannot be started.
ChildEnd run_child(const std::string& program, const std::vector<std::string>& arguments,
                   const ChildLimits& limits, const std::function<bool()>& cancelled);

}  // namespace supple::tools
