// Statistics of lengths: of displacements, of errors.
#pragma once

#include <cstdint>
#include <vector>

namespace supple {

/// Lengths in mm, all 0 where there are none.
struct LengthStatistics {
  std::int64_t count = 0;
  double mean_mm = 0;
  double rms_mm = 0;
  double median_mm = 0;  // the shortest that half of them do not exceed
  double p95_mm = 0;     // the shortest that 95 % of them do not exceed
  double max_mm = 0;
};

/// Sums go in the order of the lengths. Cost: 10 ns per length.
LengthStatistics statistics_of(std::vector<float> lengths_mm);

}  // namespace supple
