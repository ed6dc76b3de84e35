// Operations, which `supple run` computes with all that they write, and `supple replay` as a live
// session would, with a picture after each step.
#pragma once

#include <optional>
#include <string>

#include "tools/console/console.h"
#include "volumes/base/fields.h"
#include "volumes/base/table.h"

namespace supple::tools {

struct OperationCommand {
  std::string folder = ".";
  bool allows_outside = false;    // of the folder
  bool is_replay = false;         // draws every step and writes nothing
  bool is_dry = false;            // checks the scene and tells its outputs
  double duration_s = 0;          // in place of the scene's; 0: that
  std::optional<PixelSize> size;  // of the first view, in place of the scene's
  std::string image;              // of the end, of the first view; empty: none
  std::string check;              // digest that it must lead to; empty: none
};

/// Returns an exit code. Throws as read_operation() and OperationRun.
int run_operation(Table root, const OperationCommand& command, const GlobalOptions& global,
                  Console& console);

/// Tells the score of a log, which is found anew from its steps. Throws as OperationLogReader.
int tell_score_of(const std::string& log, const GlobalOptions& global);

/// Throws UsageError for an option that operations do not have.
void refuse_option(bool is_given, const char* option);

}  // namespace supple::tools
