// A quantity that a row of `supple stress` measured, and the bounds that it was promised to keep.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

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

}  // namespace supple::tools
