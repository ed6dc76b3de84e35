#include "tools/lab/stress/measured_value.h"

#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "volumes/base/error.h"

namespace supple::tools {

bool MeasuredValue::holds() const {
  return std::isfinite(value) && value >= least && value <= most;
}

std::string measured_text(const MeasuredValue& measured) {
  std::string text = measured.what + " " + number_text(measured.value);
  if (measured.holds()) return text;
  const bool is_one_value = measured.least == measured.most;
  return text + " (not " + number_text(measured.least) +
         (is_one_value ? "" : " to " + number_text(measured.most)) + ")";
}

nlohmann::ordered_json to_json(const MeasuredValues& all) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const MeasuredValue& one : all) {
    json.push_back(
        {{"what", one.what}, {"value", one.value}, {"least", one.least}, {"most", one.most}});
  }
  return json;
}

MeasuredValues measured_values_of(const nlohmann::ordered_json& json) {
  MeasuredValues all;
  for (const nlohmann::ordered_json& one : json) {
    const nlohmann::ordered_json& value = one.at("value");
    all.push_back({one.at("what"),
                   value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>(),
                   one.at("least"), one.at("most")});
  }
  return all;
}

}  // namespace supple::tools
