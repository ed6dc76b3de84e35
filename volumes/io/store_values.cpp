#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "volumes/io/stored_values.h"

namespace supple {

namespace {

template <class Value>
Value rounded(double value) {
  using Limits = std::numeric_limits<Value>;
  if constexpr (std::is_floating_point_v<Value>) return Value(value);
  if (std::isnan(value)) return Value(0);
  if (value >= double(Limits::max())) return Limits::max();
  if (value <= double(Limits::lowest())) return Limits::lowest();
  return Value(std::round(value));
}

template <class Value, class Number>
void store_all(const Number* values, std::size_t count, char* out) {
  for (std::size_t n = 0; n < count; ++n) {
    const Value value = rounded<Value>(double(values[n]));
    std::memcpy(out + n * sizeof value, &value, sizeof value);
  }
}

template <class Number>
void store(ValueType type, const Number* values, std::size_t count, char* out) {
  switch (type) {
    case ValueType::int8:
      return store_all<std::int8_t>(values, count, out);
    case ValueType::uint8:
      return store_all<std::uint8_t>(values, count, out);
    case ValueType::int16:
      return store_all<std::int16_t>(values, count, out);
    case ValueType::uint16:
      return store_all<std::uint16_t>(values, count, out);
    case ValueType::int32:
      return store_all<std::int32_t>(values, count, out);
    case ValueType::uint32:
      return store_all<std::uint32_t>(values, count, out);
    case ValueType::int64:
      return store_all<std::int64_t>(values, count, out);
    case ValueType::uint64:
      return store_all<std::uint64_t>(values, count, out);
    case ValueType::float32:
      return store_all<float>(values, count, out);
    case ValueType::float64:
      return store_all<double>(values, count, out);
  }
}

}  // namespace

void store_values(ValueType type, const float* values, std::size_t count, char* out) {
  store(type, values, count, out);
}

void store_values(ValueType type, const double* values, std::size_t count, char* out) {
  store(type, values, count, out);
}

}  // namespace supple
