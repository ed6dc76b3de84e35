// PLY: a text header declares elements and their properties, then come the values as text or in
// either byte order. Elements other than vertices and faces are read over.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>

#include "volumes/base/error.h"
#include "volumes/io/text_header.h"
#include "volumes/mesh/mesh_formats.h"

namespace supple {

namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

const std::map<std::string_view, Type> kTypes = {
    {"char", Type::int8},      {"int8", Type::int8},       {"uchar", Type::uint8},
    {"uint8", Type::uint8},    {"short", Type::int16},     {"int16", Type::int16},
    {"ushort", Type::uint16},  {"uint16", Type::uint16},   {"int", Type::int32},
    {"int32", Type::int32},    {"uint", Type::uint32},     {"uint32", Type::uint32},
    {"float", Type::float32},  {"float32", Type::float32}, {"double", Type::float64},
    {"float64", Type::float64}};

std::size_t size_of(Type type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[int(type)];
}

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count_type;  // of a list
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

Type type_of(const MeshWords& words, std::string_view name) {
  const auto found = kTypes.find(name);
  if (found == kTypes.end()) words.fail(name, "a type of PLY, such as float or uchar");
  return found->second;
}

Format read_format(MeshWords& words) {
  const std::string_view name = words.next_on_line();
  if (name == "ascii") return Format::text;
  if (name == "binary_little_endian") return Format::little_endian;
  if (name == "binary_big_endian") return Format::big_endian;
  words.fail(name, "ascii, binary_little_endian or binary_big_endian");
}

Element read_element(MeshWords& words) {
  const std::string name(words.next_on_line());
  const std::string_view word = words.next_on_line();
  const double count = words.number(word);
  if (!(count >= 0 && count < 2147483647) || count != std::floor(count)) {
    words.fail(word, "a count from 0 to 2147483646");
  }
  return {name, std::int64_t(count), {}};
}

Property read_property(MeshWords& words) {
  Property property;
  std::string_view type = words.next_on_line();
  if (type == "list") {
    property.count_type = type_of(words, words.next_on_line());
    type = words.next_on_line();
  }
  property.type = type_of(words, type);
  property.name = words.next_on_line();
  return property;
}

void require_coordinates(const MeshWords& words, const Element& vertex) {
  for (const char* name : {"x", "y", "z"}) {
    const bool found = std::any_of(vertex.properties.begin(), vertex.properties.end(),
                                   [&](const Property& property) { return property.name == name; });
    if (!found) words.fail("vertices without " + std::string(name), "properties x, y and z");
  }
}

Header read_header(MeshWords& words) {
  Header header;
  bool has_format = false;
  words.expect("ply");
  while (true) {
    words.skip_line();
    const std::string_view keyword = words.next_on_line();
    if (keyword == "end_header") break;
    if (keyword == "comment" || keyword == "obj_info") continue;
    if (keyword == "format") {
      header.format = read_format(words);
      has_format = true;
    } else if (keyword == "element") {
      header.elements.push_back(read_element(words));
    } else if (keyword == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(read_property(words));
    } else {
      words.fail(keyword, "format, element, property or end_header");
    }
  }
  words.skip_line();
  if (!has_format) words.fail("no format", "a line with the format");
  for (const Element& element : header.elements) {
    if (element.name == "vertex") require_coordinates(words, element);
  }
  return header;
}

/// The values behind the header, one after the other; `words` stand at the first.
class Values {
 public:
  Values(const std::string& path, const std::string& content, Format format, MeshWords& words)
      : m_path(path),
        m_content(content),
        m_format(format),
        m_words(words),
        m_position(words.position()) {}

  double next(Type type) {
    if (m_format == Format::text) return m_words.number();
    const std::size_t size = size_of(type);
    if (m_content.size() - m_position < size) {
      throw InputError({m_path, "PLY", "data that end early", "all values of the header"});
    }
    char bytes[8];
    for (std::size_t n = 0; n < size; ++n) {
      bytes[m_format == Format::big_endian ? size - 1 - n : n] = m_content[m_position + n];
    }
    m_position += size;
    return decode(type, bytes);
  }

  std::size_t bytes_left() const {
    return m_content.size() - (m_format == Format::text ? m_words.position() : m_position);
  }

 private:
  template <class Value>
  static double as(const char* bytes) {
    Value value;
    std::memcpy(&value, bytes, sizeof value);
    return double(value);
  }
  static double decode(Type type, const char* bytes) {
    switch (type) {
      case Type::int8:
        return as<std::int8_t>(bytes);
      case Type::uint8:
        return as<std::uint8_t>(bytes);
      case Type::int16:
        return as<std::int16_t>(bytes);
      case Type::uint16:
        return as<std::uint16_t>(bytes);
      case Type::int32:
        return as<std::int32_t>(bytes);
      case Type::uint32:
        return as<std::uint32_t>(bytes);
      case Type::float32:
        return as<float>(bytes);
      case Type::float64:
        return as<double>(bytes);
    }
    return 0;
  }

  const std::string& m_path;
  const std::string& m_content;
  Format m_format;
  MeshWords& m_words;
  std::size_t m_position;
};

/// A list's values; its count must fit into the bytes that are left.
std::vector<double> read_list(const std::string& path, const Property& property, Values& values) {
  const double count = values.next(*property.count_type);
  if (!(count >= 0 && count <= double(values.bytes_left()) && count == std::floor(count))) {
    throw InputError({path, "PLY list " + printable(property.name), number_text(count) + " values",
                      "as many as the file can hold"});
  }
  std::vector<double> list(std::size_t(count), 0.0);
  for (double& value : list) value = values.next(property.type);
  return list;
}

void add_face(const std::string& path, const std::vector<double>& indices, TriangleMesh& mesh) {
  std::vector<int> polygon;
  for (const double index : indices) {
    if (!(index >= 0 && index < 2147483647) || index != std::floor(index)) {
      throw InputError({path, "PLY face", number_text(index), "the number of a vertex"});
    }
    polygon.push_back(int(index));
  }
  add_polygon(polygon, mesh);
}

/// Every item of the element; a property takes at least one byte of the file.
void read_items(const std::string& path, const Element& element, Values& values,
                TriangleMesh& mesh) {
  if (element.count > 0 &&
      (element.properties.empty() || std::size_t(element.count) > values.bytes_left())) {
    throw InputError({path, "PLY element " + printable(element.name),
                      std::to_string(element.count) + " items of " +
                          std::to_string(element.properties.size()) + " properties in " +
                          std::to_string(values.bytes_left()) + " bytes",
                      "as many as the file can hold"});
  }
  for (std::int64_t item = 0; item < element.count; ++item) {
    Vec3d vertex(0);
    for (const Property& property : element.properties) {
      if (property.count_type) {
        const std::vector<double> list = read_list(path, property, values);
        const bool is_face = element.name == "face" &&
                             (property.name == "vertex_indices" || property.name == "vertex_index");
        if (is_face) add_face(path, list, mesh);
        continue;
      }
      const double value = values.next(property.type);
      if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z') {
        vertex[property.name[0] - 'x'] = value;
      }
    }
    if (element.name == "vertex") mesh.vertices_lps_mm.push_back(vertex);
  }
}

}  // namespace

TriangleMesh read_ply(const std::string& path, const std::string& content) {
  MeshWords words(path, content);
  const Header header = read_header(words);
  Values values(path, content, header.format, words);
  TriangleMesh mesh;
  for (const Element& element : header.elements) read_items(path, element, values, mesh);
  return mesh;
}

}  // namespace supple
