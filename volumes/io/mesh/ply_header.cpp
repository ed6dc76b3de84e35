#include "volumes/io/mesh/ply_header.h"

#include <algorithm>
#include <map>

namespace supple::ply {

namespace {

const std::map<std::string_view, PlyType> kPlyTypes = {
    {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
    {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
    {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
    {"float64", PlyType::float64}};

PlyType type_of(const MeshWords& words, std::string_view name) {
  const auto found = kPlyTypes.find(name);
  if (found == kPlyTypes.end()) words.fail(name, "a type of PLY, such as float or uchar");
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

std::size_t size_of(PlyType type) {
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
