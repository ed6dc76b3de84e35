#include <array>

#include "volumes/io/formats.h"

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

}  // namespace supple
