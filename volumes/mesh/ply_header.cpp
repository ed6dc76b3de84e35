#include "volumes/mesh/ply_header.h"

#include <algorithm>
#include <map>

namespace supple::ply {

namespace {

const std::map<std::string_view, Type> kTypes = {
    {"char", Type::int8},      {"int8", Type::int8},       {"uchar", Type::uint8},
    {"uint8", Type::uint8},    {"short", Type::int16},     {"int16", Type::int16},
    {"ushort", Type::uint16},  {"uint16", Type::uint16},   {"int", Type::int32},
    {"int32", Type::int32},    {"uint", Type::uint32},     {"uint32", Type::uint32},
    {"float", Type::float32},  {"float32", Type::float32}, {"double", Type::float64},
    {"float64", Type::float64}};

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
  return {name, words.count(words.next_on_line()), {}};
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

}  // namespace

std::size_t size_of(Type type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[int(type)];
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

}  // namespace supple::ply
