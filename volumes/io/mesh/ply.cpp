// PLY: a text header declares elements and their properties, then come the values as text or in
// either byte order. Elements other than vertices, faces and, in networks, edges are read over.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/mesh/ply_header.h"

namespace supple {

namespace {

using namespace ply;

/// The values behind the header, one after the other; `words` stand at the first.
class Values {
 public:
  Values(const std::string& path, const std::string& content, Format format, MeshWords& words)
      : m_path(path),
        m_content(content),
        m_format(format),
        m_words(words),
        m_position(words.position()) {}

  double next(PlyType type) {
    if (m_format == Format::text) {
      const std::string_view word = m_words.next();
      const bool is_float = type == PlyType::float32;
      m_slot = m_words.slot_of(word, is_float ? NumberCode::text_float : NumberCode::text);
      return m_words.number(word);
    }
    const std::size_t size = size_of(type);
    if (m_content.size() - m_position < size) {
      throw InputError({m_path, "PLY", "data that end early", "all values of the header"});
    }
    char bytes[8];
    for (std::size_t n = 0; n < size; ++n) {
      bytes[m_format == Format::big_endian ? size - 1 - n : n] = m_content[m_position + n];
    }
    const int big = m_format == Format::big_endian;
    const auto code =
        type == PlyType::float32 ? NumberCode::float32_little : NumberCode::float64_little;
    m_slot = {m_position, std::uint32_t(size), NumberCode(int(code) + big)};
    m_position += size;
    return decode(type, bytes);
  }

  /// The place of the last number.
  const NumberSlot& slot() const { return m_slot; }

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
  static double decode(PlyType type, const char* bytes) {
    switch (type) {
      case PlyType::int8:
        return as<std::int8_t>(bytes);
      case PlyType::uint8:
        return as<std::uint8_t>(bytes);
      case PlyType::int16:
        return as<std::int16_t>(bytes);
      case PlyType::uint16:
        return as<std::uint16_t>(bytes);
      case PlyType::int32:
        return as<std::int32_t>(bytes);
      case PlyType::uint32:
        return as<std::uint32_t>(bytes);
      case PlyType::float32:
        return as<float>(bytes);
      case PlyType::float64:
        return as<double>(bytes);
    }
    return 0;
  }

  const std::string& m_path;
  const std::string& m_content;
  Format m_format;
  MeshWords& m_words;
  std::size_t m_position;
  NumberSlot m_slot;
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

int vertex_number(const std::string& path, const std::string& of, double index) {
  if (!(index >= 0 && index < 2147483647) || index != std::floor(index)) {
    throw InputError({path, "PLY " + of, number_text(index), "the number of a vertex"});
  }
  return int(index);
}

void add_face(const std::string& path, const std::vector<double>& indices, TriangleMesh& mesh) {
  std::vector<int> polygon;
  for (const double index : indices) polygon.push_back(vertex_number(path, "face", index));
  add_polygon(polygon, mesh);
}

/// An edge must have both ends.
void require_ends(const std::string& path, const Element& element) {
  int ends = 0;
  for (const Property& property : element.properties) {
    ends += !property.count_type && (property.name == "vertex1" || property.name == "vertex2");
  }
  if (ends == 2) return;
  throw InputError({path, "PLY element edge", std::to_string(ends) + " of its vertices",
                    "properties vertex1 and vertex2"});
}

/// The vector that a property of a vertex belongs to, and its component.
struct VertexProperty {
  enum { position, normal, other } vector = other;
  std::size_t component = 0;
};

VertexProperty vertex_property(const std::string& path, const Property& property) {
  VertexProperty result;
  const std::string& name = property.name;
  const char last = name.empty() ? ' ' : name.back();
  if (last < 'x' || last > 'z' || name.size() > 2 || (name.size() == 2 && name[0] != 'n')) {
    return result;
  }
  result.vector = name.size() == 1 ? VertexProperty::position : VertexProperty::normal;
  result.component = std::size_t(last - 'x');
  if (property.type == PlyType::float32 || property.type == PlyType::float64) return result;
  if (result.vector == VertexProperty::normal) return {};
  throw InputError({path, "PLY property " + name, "an integer type",
                    "float or double, so that vertices can move"});
}

/// Places of the vertices of a file and of their normals.
class VertexSlots {
 public:
  VertexSlots(const std::string& path, const Element& element, MeshSlots* slots) : m_slots(slots) {
    if (slots == nullptr || element.name != "vertex") {
      m_slots = nullptr;
      return;
    }
    int components = 0;
    for (const Property& property : element.properties) {
      m_properties.push_back(property.count_type ? VertexProperty{}
                                                 : vertex_property(path, property));
      components += m_properties.back().vector == VertexProperty::normal;
    }
    m_has_normals = components == 3;
  }

  void take(std::size_t property, double value, const NumberSlot& slot) {
    if (m_slots == nullptr) return;
    const VertexProperty& found = m_properties[property];
    if (found.vector == VertexProperty::position) m_position[found.component] = slot;
    if (found.vector == VertexProperty::normal) {
      m_normal[found.component] = slot;
      m_direction[int(found.component)] = value;
    }
  }
  void end_vertex() {
    if (m_slots == nullptr) return;
    if (m_has_normals) {
      m_slots->add_normal(m_normal, m_direction, {int(m_slots->positions.size())});
    }
    m_slots->positions.push_back(m_position);
  }

 private:
  MeshSlots* m_slots;
  std::vector<VertexProperty> m_properties;
  bool m_has_normals = false;
  VectorSlot m_position, m_normal;
  Vec3d m_direction{0, 0, 0};
};

/// Every item of the element; a property takes at least one byte of the file.
void read_items(const std::string& path, const Element& element, Values& values, TriangleMesh& mesh,
                MeshSlots* slots, MeshLines* lines) {
  if (element.count > 0 &&
      (element.properties.empty() || std::size_t(element.count) > values.bytes_left())) {
    throw InputError({path, "PLY element " + printable(element.name),
                      std::to_string(element.count) + " items of " +
                          std::to_string(element.properties.size()) + " properties in " +
                          std::to_string(values.bytes_left()) + " bytes",
                      "as many as the file can hold"});
  }
  VertexSlots vertex_slots(path, element, slots);
  const bool is_edge = lines != nullptr && element.name == "edge";
  if (is_edge) require_ends(path, element);
  for (std::int64_t item = 0; item < element.count; ++item) {
    Vec3d vertex(0);
    std::array<int, 2> edge{};
    for (std::size_t n = 0; n < element.properties.size(); ++n) {
      const Property& property = element.properties[n];
      if (property.count_type) {
        const std::vector<double> list = read_list(path, property, values);
        const bool is_face = element.name == "face" &&
                             (property.name == "vertex_indices" || property.name == "vertex_index");
        if (is_face) add_face(path, list, mesh);
        continue;
      }
      const double value = values.next(property.type);
      vertex_slots.take(n, value, values.slot());
      if (is_edge && property.name == "vertex1") edge[0] = vertex_number(path, "edge", value);
      if (is_edge && property.name == "vertex2") edge[1] = vertex_number(path, "edge", value);
      if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z') {
        vertex[property.name[0] - 'x'] = value;
      }
    }
    if (element.name == "vertex") mesh.vertices_lps_mm.push_back(vertex);
    if (is_edge) lines->push_back(edge);
    vertex_slots.end_vertex();
  }
}

}  // namespace

TriangleMesh read_ply(const std::string& path, const std::string& content, MeshSlots* slots,
                      MeshLines* lines) {
  MeshWords words(path, content);
  const Header header = read_header(words);
  Values values(path, content, header.format, words);
  TriangleMesh mesh;
  for (const Element& element : header.elements) {
    read_items(path, element, values, mesh, slots, lines);
  }
  return mesh;
}

}  // namespace supple
