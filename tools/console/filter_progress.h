// Progress by the contract of 3D Slicer's command-line modules: lines of XML on stdout.
#pragma once

#include <chrono>
#include <string>

namespace supple::tools {

/// Stages one after the other, of which the last ends with the object.
class FilterProgress {
 public:
  /// Prints where the environment variable SUPPLE_PROGRESS is "slicer", and nothing elsewhere.
  FilterProgress();
  ~FilterProgress() { end(); }
  FilterProgress(const FilterProgress&) = delete;
  FilterProgress& operator=(const FilterProgress&) = delete;

  void begin(const std::string& stage);
  void update(double fraction);

 private:
  void end();

  bool m_prints;
  std::string m_stage;  // empty: none
  double m_told = 0;    // fraction that was printed last
  std::chrono::steady_clock::time_point m_start;
};

}  // namespace supple::tools
