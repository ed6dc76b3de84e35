#include "tools/lab/stress/stress_verdict.h"

#include <algorithm>

#include <nlohmann/json.hpp>

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

}  // namespace supple::tools
