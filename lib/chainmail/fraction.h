// The part of a drag that is performed, kept rational so that its direction is kept.
#pragma once

#include <cstdint>
#include <numeric>

namespace supple {

/// A part of the whole, 0…1, reduced.
struct Fraction {
  std::int64_t numerator = 1;
  std::int64_t denominator = 1;

  bool is_whole() const { return numerator == denominator; }
  /// The smaller of both; the parts of each are below 2^31.
  void limit_to(std::int64_t other_numerator, std::int64_t other_denominator) {
    if (other_numerator * denominator >= numerator * other_denominator) return;
    const std::int64_t divisor = std::gcd(other_numerator, other_denominator);
    numerator = other_numerator / divisor;
    denominator = other_denominator / divisor;
  }
  /// `value` times the fraction, truncated toward zero.
  std::int32_t scale(std::int32_t value) const {
    return std::int32_t(value * numerator / denominator);
  }
};

}  // namespace supple
