#include "volumes/io/bytes/value_type.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace supple {

namespace {

struct TypeFacts {
  ValueType type;
  const char* name;
  int bytes;
};

constexpr std::array<TypeFacts, 10> kTypes = {{{ValueType::int8, "int8", 1},
                                               {ValueType::uint8, "uint8", 1},
                                               {ValueType::int16, "int16", 2},
                                               {ValueType::uint16, "uint16", 2},
                                               {ValueType::int32, "int32", 4},
                                               {ValueType::uint32, "uint32", 4},
                                               {ValueType::int64, "int64", 8},
                                               {ValueType::uint64, "uint64", 8},
                                               {ValueType::float32, "float32", 4},
                                               {ValueType::float64, "float64", 8}}};

template <class T>
void scale_all(const char* stored, std::size_t count, double slope, double intercept,
               double* values) {
  for (std::size_t n = 0; n < count; ++n) {
    T value;
    std::memcpy(&value, stored + n * sizeof(T), sizeof(T));
    values[n] = slope * double(value) + intercept;
  }
}

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

const char* numpy_name(ValueType type) {
  return kTypes[std::size_t(type)].name;
}

int bytes_of(ValueType type) {
  return kTypes[std::size_t(type)].bytes;
}

bool find_numpy_type(const std::string& name, ValueType& type) {
  for (const TypeFacts& facts : kTypes) {
    if (name != facts.name) continue;
    type = facts.type;
    return true;
  }
  return false;
}

ScaleValues scale_values_of(ValueType type) {
  switch (type) {
    case ValueType::int8:
      return scale_all<std::int8_t>;
    case ValueType::uint8:
      return scale_all<std::uint8_t>;
    case ValueType::int16:
      return scale_all<std::int16_t>;
    case ValueType::uint16:
      return scale_all<std::uint16_t>;
    case ValueType::int32:
      return scale_all<std::int32_t>;
    case ValueType::uint32:
      return scale_all<std::uint32_t>;
    case ValueType::int64:
      return scale_all<std::int64_t>;
    case ValueType::uint64:
      return scale_all<std::uint64_t>;
    case ValueType::float32:
      return scale_all<float>;
    case ValueType::float64:
      return scale_all<double>;
  }
  return scale_all<std::uint8_t>;
}

void store_values(ValueType type, const float* values, std::size_t count, char* out) {
  store(type, values, count, out);
}

void store_values(ValueType type, const double* values, std::size_t count, char* out) {
  store(type, values, count, out);
}

}  // namespace supple
