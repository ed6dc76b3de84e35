// Another run of this program: how it ended, and what it complained of.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "volumes/base/run_program.h"

namespace supple {

struct ChildEnd : ProgramEnd {
  /// The last error on stderr, without "supple: error: "; where there is none the report of a
  /// sanitizer, or the last line.
  std::string complaint;
  std::string warnings;  // all lines of warnings, likewise, joined by "; "
};

/// run_program() in the present folder.
ChildEnd run_child(const std::string& program, const std::vector<std::string>& arguments,
                   const ProgramLimits& limits, const std::function<bool()>& cancelled);

}  // namespace supple
