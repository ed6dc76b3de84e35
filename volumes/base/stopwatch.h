// Wall time, and processor time of all threads together: that hardly depends on what else the
// machine does. And what a piece of work costs, from the last ones.
#pragma once

#include <chrono>

namespace supple {

double ms_since(std::chrono::steady_clock::time_point start);

/// Processor time of all threads of the process so far.
double processor_seconds();

/// Processor time for loading the program and its libraries, before main().
double loading_seconds();

/// A clock that runs from its making.
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

/// A running mean of a cost per piece of work, which follows the last few.
class CostPer {
 public:
  explicit CostPer(double guess_ms) : m_ms(guess_ms) {}
  double of(double count) const { return m_ms * count; }
  void add(double ms, double count) {
    if (count <= 0) return;
    m_ms = m_is_measured ? 0.6 * m_ms + 0.4 * ms / count : ms / count;
    m_is_measured = true;
  }

 private:
  double m_ms;
  bool m_is_measured = false;
};

}  // namespace supple
