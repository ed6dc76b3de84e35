// Random numbers that are the same on any machine: those of the standard library's distributions
// are not.
#pragma once

#include <cstdint>
#include <random>

#include "volumes/base/vec.h"

namespace supple::tools {

class RandomNumbers {
 public:
  /// Begins the sequence of one of many samples with this seed.
  RandomNumbers(std::uint64_t seed, std::uint64_t sample);

  /// A number from `lo` to below `hi`.
  double between(double lo, double hi);
  /// A whole number from 0 to below `count`, which is above 0.
  std::size_t below(std::size_t count);
  /// A direction in space, of length 1.
  Vec3d direction();

 private:
  std::mt19937_64 m_engine;
};

}  // namespace supple::tools
