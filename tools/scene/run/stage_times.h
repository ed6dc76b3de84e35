// Seconds of the stages of a piece of work.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace supple::tools {

/// Seconds of stages by name, in the order in which they began; equal names are added up.
using StageSeconds = std::vector<std::pair<std::string, double>>;

class StageTimes {
 public:
  /// Ends the running stage and begins another one.
  void begin(std::string_view name);
  void end();
  const StageSeconds& seconds() const { return m_seconds; }

 private:
  std::string m_stage;  // empty: none runs
  std::chrono::steady_clock::time_point m_start;
  StageSeconds m_seconds;
};

}  // namespace supple::tools
