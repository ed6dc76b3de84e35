// The verdict on a row: whether its end agrees with what was expected of it.
#pragma once

#include <string>

#include "tools/lab/stress/measured_value.h"
#include "volumes/base/process.h"

namespace supple::tools {

/// The row ends with this exit code and an error that holds this text.
struct ExpectedRefusal {
  int exit_code;
  std::string text;
};

struct StressVerdict {
  bool agrees = false;
  std::string found;        // what was measured, or how it ended
  MeasuredValues measured;  // of a row that ended well
};

/// Without an expected refusal the row must end well, and say of measured values that all of them
/// hold; at least one.
StressVerdict verdict_of(const ExpectedRefusal* expected, const ChildEnd& end);

}  // namespace supple::tools
