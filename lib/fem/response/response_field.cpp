#include "lib/fem/response/response_field.h"

#include <algorithm>

#include "volumes/base/simd.h"

namespace supple {

namespace {

constexpr std::size_t kLanes = 8;
using Eight = Pack<float, kLanes>;

}  // namespace

void ResponseField::sum(const std::vector<double>& parts, std::size_t begin, std::size_t end,
                        Vec3f* out) const {
  std::vector<float> factors;
  std::vector<const float*> from;
  for (std::size_t r = 0; r < m_values.size(); ++r) {
    if (parts[r] == 0) continue;
    factors.push_back(float(parts[r]));
    from.push_back(m_values[r]->data() + 3 * begin);
  }
  float* to = &out->x;
  const std::size_t count = 3 * (end - begin), whole = count - count % kLanes;
  for (std::size_t n = 0; n < whole; n += kLanes) {
    Eight sum{};
    for (std::size_t r = 0; r < from.size(); ++r) {
      sum += factors[r] * load_pack<Eight>(from[r] + n);
    }
    store_pack(to + n, sum);
  }
  // The rest in lanes too: single numbers would be rounded otherwise.
  if (whole == count) return;
  Eight sum{};
  for (std::size_t r = 0; r < from.size(); ++r) {
    Eight last{};
    for (std::size_t n = whole; n < count; ++n) last[n - whole] = from[r][n];
    sum += factors[r] * last;
  }
  for (std::size_t n = whole; n < count; ++n) to[n] = sum[n - whole];
}

std::vector<float> changes_between(const std::vector<float>& now, const std::vector<float>& then,
                                   std::size_t every, double least_part) {
  const auto at = [](const std::vector<float>& values, std::size_t n) {
    return Vec3f(values[n], values[n + 1], values[n + 2]);
  };
  double most = 0;
  for (std::size_t n = 0; n < now.size(); n += 3 * every) {
    most = std::max(most, double(at(now, n).length()));
  }
  std::vector<float> lengths;
  for (std::size_t n = 0; n < now.size(); n += 3 * every) {
    if (double(at(now, n).length()) < least_part * most) continue;
    lengths.push_back(float((at(now, n) - at(then, n)).length()));
  }
  return lengths;
}

std::size_t ResponseField::bytes() const {
  std::size_t sum = 0;
  for (const ResponseValues& values : m_values) sum += values->capacity() * sizeof(float);
  return sum;
}

}  // namespace supple
