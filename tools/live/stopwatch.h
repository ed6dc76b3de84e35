// Wall time, and processor time of all threads together: that hardly depends on what else the
// machine does.
#pragma once

#include <chrono>

namespace supple::tools {

double ms_since(std::chrono::steady_clock::time_point start);

/// Runs from its making.
class Stopwatch {
 public:
  /// `started`: before, for the time; processor time counts from now.
  explicit Stopwatch(
      std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now());
  double ms() const { return ms_since(m_start); }
  double cpu_ms() const;

 private:
  std::chrono::steady_clock::time_point m_start;
  double m_cpu_ms;
};

}  // namespace supple::tools
