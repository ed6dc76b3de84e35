// Floats of half the memory, for what need not be exact.
#pragma once

#include <cstdint>
#include <cstring>

namespace supple {

/// The upper half of a float (bfloat16): its range, rounded to eight bits.
class ShortFloat {
 public:
  ShortFloat() = default;
  explicit ShortFloat(float value) {
    std::uint32_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    m_upper = std::uint16_t((bits + 0x7fff + (bits >> 16 & 1)) >> 16);
  }
  operator float() const {
    const std::uint32_t bits = std::uint32_t(m_upper) << 16;
    float value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }

 private:
  std::uint16_t m_upper = 0;
};

}  // namespace supple
