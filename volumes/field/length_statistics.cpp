#include "volumes/field/length_statistics.h"

#include <algorithm>
#include <cmath>

namespace supple {

LengthStatistics statistics_of(std::vector<float> lengths_mm) {
  LengthStatistics statistics;
  if (lengths_mm.empty()) return statistics;
  double sum = 0, squares = 0;
  for (const float length : lengths_mm) {
    sum += length;
    squares += double(length) * length;
  }
  const double count = double(lengths_mm.size());
  statistics.count = std::int64_t(lengths_mm.size());
  statistics.mean_mm = sum / count;
  statistics.rms_mm = std::sqrt(squares / count);
  statistics.max_mm = *std::max_element(lengths_mm.begin(), lengths_mm.end());
  const auto not_exceeded_by = [&](double part) {
    const auto rank = lengths_mm.begin() + std::ptrdiff_t(std::ceil(part * count)) - 1;
    std::nth_element(lengths_mm.begin(), rank, lengths_mm.end());
    return double(*rank);
  };
  statistics.median_mm = not_exceeded_by(0.5);
  statistics.p95_mm = not_exceeded_by(0.95);
  return statistics;
}

}  // namespace supple
