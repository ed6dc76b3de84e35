#include "tools/scene/augment/random_numbers.h"

namespace supple::tools {

namespace {

std::mt19937_64 engine_of(std::uint64_t seed, std::uint64_t sample) {
  std::seed_seq words{std::uint32_t(seed), std::uint32_t(seed >> 32), std::uint32_t(sample),
                      std::uint32_t(sample >> 32)};
  return std::mt19937_64(words);
}

}  // namespace

RandomNumbers::RandomNumbers(std::uint64_t seed, std::uint64_t sample)
    : m_engine(engine_of(seed, sample)) {}

double RandomNumbers::between(double lo, double hi) {
  constexpr double kUnit = 1.0 / 9007199254740992.0;  // 2^-53
  return lo + (hi - lo) * (double(m_engine() >> 11) * kUnit);
}

std::size_t RandomNumbers::below(std::size_t count) {
  return std::size_t(between(0, double(count)));
}

Vec3d RandomNumbers::direction() {
  for (;;) {
    const double x = between(-1, 1), y = between(-1, 1), z = between(-1, 1);
    const Vec3d way(x, y, z);
    const double length = way.length();
    if (length > 0.1 && length <= 1) return way / length;
  }
}

}  // namespace supple::tools
