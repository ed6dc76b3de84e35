#include <array>
#include <cstdint>
#include <cstring>

#include "volumes/io/stored_values.h"

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

std::int64_t stored_bytes(const VolumeHeader& header) {
  return header.geometry.voxel_count() * header.components * bytes_of(header.type);
}

}  // namespace supple
