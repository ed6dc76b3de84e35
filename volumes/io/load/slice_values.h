// Stored values of a slice as densities, with their statistics, in one pass.
// Cost: about 0.5 ns per unscaled integer of at most 32 bits, 3 ns for all others.
#pragma once

#include <cstdint>

#include "volumes/io/format/volume_file.h"

namespace supple {

/// Statistics of values: of finite ones after slope and intercept; sums are those of blocks.
struct SliceStatistics {
  double min, max;  // infinite without a finite value
  double sum = 0;
  std::int64_t finite_count = 0;
  std::int64_t min_count = 0;  // values equal to min
  std::int64_t nan_count = 0;
  std::int64_t infinite_count = 0;  // values that overflow a float included

  SliceStatistics();
  /// `later` describes values behind these.
  void append(const SliceStatistics& later);
};

/// Writes slope * stored + intercept, or NaN where that is not finite as a float.
SliceStatistics densities_of(const VolumeHeader& header, const char* stored, std::size_t count,
                             float* out);

}  // namespace supple
