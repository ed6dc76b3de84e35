// The header of a PLY file: its encoding, and the elements and properties that follow.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "volumes/io/mesh/mesh_formats.h"

namespace supple::ply {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
std::size_t size_of(PlyType type);

struct Property {
  std::string name;
  PlyType type;
  std::optional<PlyType> count_type;  // of a list
};

struct Element {
  std::string name;
  std::int64_t count;
  std::vector<Property> properties;
};

enum class Format { text, little_endian, big_endian };

struct Header {
  Format format = Format::text;
  std::vector<Element> elements;
};

/// Throws InputError through `words`, which then stand at the first value.
Header read_header(MeshWords& words);

}  // namespace supple::ply
