#include "lib/chainmail/fraction.h"

#include <numeric>

namespace supple {

void Fraction::limit_to(std::int64_t other_numerator, std::int64_t other_denominator) {
  if (other_numerator * denominator >= numerator * other_denominator) return;
  const std::int64_t divisor = std::gcd(other_numerator, other_denominator);
  numerator = other_numerator / divisor;
  denominator = other_denominator / divisor;
}

std::int32_t Fraction::scale(std::int32_t value) const {
  return std::int32_t(value * numerator / denominator);
}

}  // namespace supple
