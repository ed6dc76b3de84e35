#include "volumes/io/load/slice_values.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "volumes/io/bytes/value_type.h"

namespace supple {

namespace {

constexpr std::size_t kBlock = 1024;
constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();

/// Sums run in eight lanes, which the compiler turns into vectors, in a fixed order.
SliceStatistics scaled_block(const double* values, std::size_t count, float* out) {
  constexpr std::size_t kLanes = 8;
  SliceStatistics block;
  double sums[kLanes] = {};
  for (std::size_t n = 0; n < count; ++n) {
    const float density = float(values[n]);
    const bool finite = std::abs(density) <= std::numeric_limits<float>::max();
    out[n] = finite ? density : kNoValue;
    sums[n % kLanes] += finite ? values[n] : 0.0;
    block.finite_count += finite;
    block.nan_count += std::isnan(values[n]);
    block.min = finite && values[n] < block.min ? values[n] : block.min;
    block.max = finite && values[n] > block.max ? values[n] : block.max;
  }
  for (const double sum : sums) block.sum += sum;
  block.min_count = std::count(values, values + count, block.min);
  block.infinite_count = std::int64_t(count) - block.finite_count - block.nan_count;
  return block;
}

SliceStatistics scaled_densities(const VolumeHeader& header, const char* stored, std::size_t total,
                                 float* out) {
  const ScaleValues scale = scale_values_of(header.type);
  const std::size_t width = std::size_t(bytes_of(header.type));
  SliceStatistics all;
  double values[kBlock];
  for (std::size_t start = 0; start < total; start += kBlock) {
    const std::size_t count = std::min(kBlock, total - start);
    scale(stored + start * width, count, header.slope, header.intercept, values);
    all.append(scaled_block(values, count, out + start));
  }
  return all;
}

/// Integers as they are: all of them are finite, and sums of blocks are exact.
template <class Integer, class Sum>
SliceStatistics plain_densities(const char* stored, std::size_t total, float* out) {
  SliceStatistics all;
  Integer values[kBlock];
  for (std::size_t start = 0; start < total; start += kBlock) {
    const std::size_t count = std::min(kBlock, total - start);
    std::memcpy(values, stored + start * sizeof(Integer), count * sizeof(Integer));
    Integer lo = values[0], hi = values[0];
    Sum sum = 0;
    for (std::size_t n = 0; n < count; ++n) {
      out[start + n] = float(values[n]);
      lo = std::min(lo, values[n]);
      hi = std::max(hi, values[n]);
      sum += values[n];
    }
    std::int32_t at_lo = 0;
    for (std::size_t n = 0; n < count; ++n) at_lo += values[n] == lo;
    SliceStatistics block;
    block.min = double(lo);
    block.max = double(hi);
    block.sum = double(sum);
    block.finite_count = std::int64_t(count);
    block.min_count = at_lo;
    all.append(block);
  }
  return all;
}

}  // namespace

SliceStatistics::SliceStatistics() : min(std::numeric_limits<double>::infinity()), max(-min) {}

void SliceStatistics::append(const SliceStatistics& later) {
  nan_count += later.nan_count;
  infinite_count += later.infinite_count;
  if (later.finite_count == 0) return;
  finite_count += later.finite_count;
  sum += later.sum;
  max = std::max(max, later.max);
  if (later.min < min) min_count = 0;
  min = std::min(min, later.min);
  if (later.min == min) min_count += later.min_count;
}

SliceStatistics densities_of(const VolumeHeader& header, const char* stored, std::size_t count,
                             float* out) {
  const bool is_plain = header.slope == 1 && header.intercept == 0;
  if (!is_plain) return scaled_densities(header, stored, count, out);
  switch (header.type) {
    case ValueType::int8:
      return plain_densities<std::int8_t, std::int32_t>(stored, count, out);
    case ValueType::uint8:
      return plain_densities<std::uint8_t, std::int32_t>(stored, count, out);
    case ValueType::int16:
      return plain_densities<std::int16_t, std::int32_t>(stored, count, out);
    case ValueType::uint16:
      return plain_densities<std::uint16_t, std::int32_t>(stored, count, out);
    case ValueType::int32:
      return plain_densities<std::int32_t, std::int64_t>(stored, count, out);
    case ValueType::uint32:
      return plain_densities<std::uint32_t, std::int64_t>(stored, count, out);
    default:
      return scaled_densities(header, stored, count, out);
  }
}

}  // namespace supple
