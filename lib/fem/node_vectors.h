// Loops over long vectors on all threads, with sums whose order does not depend on their number:
// ranges of a fixed length are summed one by one, and their sums in order.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "volumes/base/parallel.h"

namespace supple {

constexpr std::size_t kVectorRange = 3 << 13;

/// Calls visit(begin, end) for all ranges, in any order.
template <class Visit>
void for_ranges(std::size_t count, Visit&& visit) {
  const std::size_t ranges = (count + kVectorRange - 1) / kVectorRange;
  parallel_for(ranges, [&](std::size_t n) {
    visit(n * kVectorRange, std::min(count, (n + 1) * kVectorRange));
  });
}

/// The sum of sum_range(begin, end) over all ranges.
template <class SumRange>
double sum_ranges(std::size_t count, SumRange&& sum_range) {
  std::vector<double> sums((count + kVectorRange - 1) / kVectorRange);
  for_ranges(count, [&](std::size_t begin, std::size_t end) {
    sums[begin / kVectorRange] = sum_range(begin, end);
  });
  double sum = 0;
  for (const double part : sums) sum += part;
  return sum;
}

/// Memory of one vector in double precision, or of two in single precision, by turns: what one of
/// them held is lost when the other is written. A third in single precision is its own.
class SharedVectors {
 public:
  explicit SharedVectors(std::size_t count)
      : m_count(count), m_memory(std::make_unique<std::byte[]>(bytes())) {}

  double* one() { return static_cast<double*>(static_cast<void*>(m_memory.get())); }
  float* first() { return static_cast<float*>(static_cast<void*>(m_memory.get())); }
  float* second() { return first() + m_count; }
  float* third() { return first() + 2 * m_count; }
  std::size_t bytes() const { return m_count * 3 * sizeof(float); }

 private:
  std::size_t m_count;
  std::unique_ptr<std::byte[]> m_memory;
};

template <class T>
void fill(T* x, std::size_t count, T value) {
  for_ranges(count,
             [&](std::size_t begin, std::size_t end) { std::fill(x + begin, x + end, value); });
}

template <class A, class B>
double dot(const A* a, const B* b, std::size_t count) {
  return sum_ranges(count, [&](std::size_t begin, std::size_t end) {
    // Eight sums side by side, as the compiler may not reorder one.
    double sums[8] = {};
    std::size_t n = begin;
    for (; n + 8 <= end; n += 8) {
      for (int lane = 0; lane < 8; ++lane) sums[lane] += double(a[n + lane]) * double(b[n + lane]);
    }
    for (; n < end; ++n) sums[0] += double(a[n]) * double(b[n]);
    return ((sums[0] + sums[4]) + (sums[2] + sums[6])) +
           ((sums[1] + sums[5]) + (sums[3] + sums[7]));
  });
}

}  // namespace supple
