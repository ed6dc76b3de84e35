// The verdict on a row of `supple stress`: the quantities that it measured, with the bounds that
// they were promised to keep, and whether its end agrees with what was expected of it.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "volumes/base/process.h"

namespace supple::tools {

struct MeasuredValue {
  std::string what;  // with its unit: "farthest element, of the handle's way"
  double value = 0;
  double least = 0, most = 0;

  /// True if the value is within its bounds; one that is not finite never is.
  bool holds() const;
};
using MeasuredValues = std::vector<MeasuredValue>;

/// "farthest element 0.93"; where it does not hold also its bounds.
std::string measured_text(const MeasuredValue& measured);

/// Numbers that are not finite become null, and come back as NaN. Throws nlohmann::json::exception
/// for other JSON.
nlohmann::ordered_json to_json(const MeasuredValues& all);
MeasuredValues measured_values_of(const nlohmann::ordered_json& json);

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
