#include "tools/lab/stress/stress_verdict.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "volumes/base/error.h"

namespace supple::tools {

namespace {

std::string joined(const MeasuredValues& measured) {
  std::string text;
  for (const MeasuredValue& one : measured) text += (text.empty() ? "" : ", ") + measured_text(one);
  return text;
}

bool all_hold(const MeasuredValues& measured) {
  return std::all_of(measured.begin(), measured.end(),
                     [](const MeasuredValue& one) { return one.holds(); });
}

StressVerdict verdict_of_failure(const ExpectedRefusal* expected, const ChildEnd& end) {
  if (end.timed_out || end.over_memory || end.exit_code < 0) return {false, end.complaint, {}};
  const bool agrees = expected != nullptr && end.exit_code == expected->exit_code &&
                      end.complaint.find(expected->text) != std::string::npos;
  return {agrees, "exit code " + std::to_string(end.exit_code) + ": " + end.complaint, {}};
}

}  // namespace

StressVerdict verdict_of(const ExpectedRefusal* expected, const ChildEnd& end) {
  if (end.exit_code != 0) return verdict_of_failure(expected, end);
  StressVerdict verdict;
  try {
    verdict.measured = measured_values_of(nlohmann::ordered_json::parse(end.out));
  } catch (const nlohmann::json::exception&) {
    return {false, "no results on stdout", {}};
  }
  verdict.found = (expected != nullptr ? "not refused: " : "") + joined(verdict.measured);
  verdict.agrees = expected == nullptr && !verdict.measured.empty() && all_hold(verdict.measured);
  return verdict;
}

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
