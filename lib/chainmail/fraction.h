// The part of a drag that is performed, kept rational so that its direction is kept.
#pragma once

#include <cstdint>

namespace supple {

/// A part of the whole, 0…1, reduced.
struct Fraction {
  std::int64_t numerator = 1;
  std::int64_t denominator = 1;

  bool is_whole() const { return numerator == denominator; }
  /// The smaller of both; the parts of each are below 2^31.
  void limit_to(std::int64_t other_numerator, std::int64_t other_denominator);
  /// `value` times the fraction, truncated toward zero.
  std::int32_t scale(std::int32_t value) const;
};

}  // namespace supple
