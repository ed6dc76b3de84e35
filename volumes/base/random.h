// Random numbers that are the same on all machines: SplitMix64 (G. Steele, D. Lea and C. Flood,
// Fast splittable pseudorandom number generators, OOPSLA 2014). Those of the standard library
// differ between its implementations once they are distributed.
#pragma once

#include <cstdint>

namespace supple {

class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : m_state(seed) {}

  std::uint64_t next_bits() {
    std::uint64_t z = (m_state += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }
  /// The next number from 0 to 1, 1 excluded.
  double next() { return double(next_bits() >> 11) * 0x1p-53; }

 private:
  std::uint64_t m_state;
};

}  // namespace supple
