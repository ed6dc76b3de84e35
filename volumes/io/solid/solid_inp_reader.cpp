// Reads decks of CalculiX and Abaqus (.inp): nodes, solid elements, their sets, surfaces of
// elements, isotropic elasticity and the sections that give it to sets.
#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <unordered_map>

#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/mesh/mesh_formats.h"
#include "volumes/io/solid/element_faces.h"
#include "volumes/io/solid/solid_formats.h"

namespace supple {

namespace {

std::string upper_case(std::string text) {
  for (char& c : text) c = char(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") + 1 - begin);
}

/// Parts between commas, without blanks around them; a comma at the end of a line adds none.
std::vector<std::string> parts_of(const std::string& line) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    parts.push_back(trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  if (parts.back().empty()) parts.pop_back();
  return parts;
}

/// A line that begins with '*': its words, and parameters such as TYPE=C3D4 in capital letters.
struct Keyword {
  std::string name;
  std::map<std::string, std::string> parameters;

  std::string parameter(const std::string& key) const {
    const auto found = parameters.find(key);
    return found != parameters.end() ? found->second : "";
  }
};

constexpr std::int64_t kMostGenerated = 100'000'000;
constexpr std::size_t kDeepestSet = 100;
constexpr std::int32_t kLargestRegion = 1'000'000'000;

/// The number in "REGION_7" and "REGION_7_MATERIAL_2"; 0 in other names.
std::int32_t region_in(const std::string& set) {
  if (set.rfind("REGION_", 0) != 0) return 0;
  std::int32_t region = 0;
  const auto read = std::from_chars(set.data() + 7, set.data() + set.size(), region);
  const std::string rest = set.substr(std::size_t(read.ptr - set.data()));
  const bool is_alone = rest.empty() || rest.rfind("_MATERIAL_", 0) == 0;
  const bool is_region = read.ec == std::errc() && region > 0 && region <= kLargestRegion;
  return is_alone && is_region ? region : 0;
}

class InpReader {
 public:
  InpReader(const std::string& path, SolidMesh& mesh) : m_path(path), m_mesh(mesh) {}

  void read() {
    const std::string content = read_mesh_content(m_path);
    for (std::size_t begin = 0; begin < content.size();) {
      const std::size_t end = std::min(content.find('\n', begin), content.size());
      ++m_line;
      take_line(trimmed(content.substr(begin, end - begin)));
      begin = end + 1;
    }
    finish();
  }

 private:
  struct Element {
    std::int64_t number;
    bool is_tet;
    std::array<std::int32_t, 8> nodes;
    std::string set;
  };
  struct Range {
    std::int64_t first, step, count;
  };
  struct Set {
    std::vector<std::string> members;  // numbers of elements, names of sets
    std::vector<Range> ranges;         // of numbers
  };
  struct Section {
    std::string set, material;
  };
  struct Surface {
    std::string name;
    std::vector<std::pair<std::string, int>> sides;  // element or set, and number of a side
  };

  [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
    throw InputError({m_path, "line " + std::to_string(m_line), found, expected});
  }

  void take_line(const std::string& line) {
    if (line.empty() || line.rfind("**", 0) == 0) return;
    if (line[0] == '*') return take_keyword(line);
    const std::vector<std::string> parts = parts_of(line);
    if (m_keyword.name == "*NODE") return take_node(parts);
    if (m_keyword.name == "*ELEMENT") return take_element(parts);
    if (m_keyword.name == "*ELSET") return take_set(parts);
    if (m_keyword.name == "*SURFACE") return take_side(parts);
    if (m_keyword.name == "*ELASTIC") return take_elasticity(parts);
  }

  void take_keyword(const std::string& line) {
    if (!m_pending.empty()) fail("'" + line + "'", "the other nodes of an element");
    const std::vector<std::string> parts = parts_of(upper_case(line));
    m_keyword = {parts.front(), {}};
    for (std::size_t n = 1; n < parts.size(); ++n) {
      const std::size_t equals = parts[n].find('=');
      const std::string key = trimmed(parts[n].substr(0, equals));
      m_keyword.parameters[key] =
          equals == std::string::npos ? "" : trimmed(parts[n].substr(equals + 1));
    }
    if (m_keyword.name == "*MATERIAL") {
      m_mesh.materials.push_back({lower_case(m_keyword.parameter("NAME")), 0, 0});
    }
    if (m_keyword.name == "*SOLID SECTION") {
      m_sections.push_back({m_keyword.parameter("ELSET"), m_keyword.parameter("MATERIAL")});
    }
    if (m_keyword.name == "*SURFACE") m_surfaces.push_back({m_keyword.parameter("NAME"), {}});
  }

  double number(const std::string& text) const {
    double value = 0;
    const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || end.ptr != text.data() + text.size() || !std::isfinite(value)) {
      fail("'" + text + "'", "a number");
    }
    return value;
  }
  std::int64_t whole(const std::string& text) const {
    std::int64_t value = 0;
    const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || end.ptr != text.data() + text.size()) fail("'" + text + "'", "a number");
    return value;
  }

  void take_node(const std::vector<std::string>& parts) {
    if (parts.size() < 4) fail(with_count(std::int64_t(parts.size()), "number"), "a node: 4");
    m_nodes[whole(parts[0])] = std::int32_t(m_mesh.nodes_lps_mm.size());
    m_mesh.nodes_lps_mm.push_back({number(parts[1]), number(parts[2]), number(parts[3])});
  }

  /// Elements may go on in the next line.
  void take_element(const std::vector<std::string>& parts) {
    const std::string type = m_keyword.parameter("TYPE");
    const bool is_tet = type.rfind("C3D4", 0) == 0 || type.rfind("C3D10", 0) == 0;
    const bool is_hex = type.rfind("C3D8", 0) == 0 || type.rfind("C3D20", 0) == 0;
    if (!is_tet && !is_hex) return;
    const std::size_t count = type.rfind("C3D10", 0) == 0   ? 10
                              : type.rfind("C3D20", 0) == 0 ? 20
                              : is_tet                      ? 4
                                                            : 8;
    for (const std::string& part : parts) m_pending.push_back(whole(part));
    if (m_pending.size() < count + 1) return;
    if (m_pending.size() > count + 1) {
      fail(std::to_string(m_pending.size() - 1) + " nodes", type + ": " + std::to_string(count));
    }
    Element element{m_pending[0], is_tet, {}, m_keyword.parameter("ELSET")};
    for (std::size_t c = 0; c < (is_tet ? 4U : 8U); ++c) {
      const auto node = m_nodes.find(m_pending[c + 1]);
      if (node == m_nodes.end()) {
        fail("node " + std::to_string(m_pending[c + 1]), "a node that *NODE has above");
      }
      element.nodes[c] = node->second;
    }
    m_elements.push_back(element);
    m_pending.clear();
  }

  void take_set(const std::vector<std::string>& parts) {
    Set& set = m_sets[m_keyword.parameter("ELSET")];
    if (m_keyword.parameters.count("GENERATE") != 0 && parts.size() >= 2) {
      set.ranges.push_back(range_of(parts));
      return;
    }
    for (const std::string& part : parts) set.members.push_back(upper_case(part));
  }

  /// "first, last, step" of a set that is generated.
  Range range_of(const std::vector<std::string>& parts) const {
    const std::int64_t first = whole(parts[0]), last = whole(parts[1]);
    const std::int64_t step = parts.size() > 2 ? std::max<std::int64_t>(1, whole(parts[2])) : 1;
    if (first < 0 || last < first) {
      fail(parts[0] + " to " + parts[1], "numbers from 0 on, ascending");
    }
    const std::int64_t steps = (last - first) / step;
    if (steps >= kMostGenerated) {
      fail(parts[0] + " to " + parts[1], "at most " + std::to_string(kMostGenerated) + " elements");
    }
    return {first, step, steps + 1};
  }

  void take_side(const std::vector<std::string>& parts) {
    if (parts.size() < 2 || parts[1].size() != 2 || upper_case(parts[1])[0] != 'S') return;
    m_surfaces.back().sides.emplace_back(upper_case(parts[0]), parts[1][1] - '1');
  }

  /// Two constants where the type is isotropic, as it is where none is given.
  void take_elasticity(const std::vector<std::string>& parts) {
    const std::string type = m_keyword.parameter("TYPE");
    if (!type.empty() && type.rfind("ISO", 0) != 0) return;
    if (m_mesh.materials.empty()) fail("*ELASTIC", "*MATERIAL before it");
    SolidMaterial& material = m_mesh.materials.back();
    if (parts.size() < 2 || material.young_kpa != 0) return;  // others are of temperatures
    material.young_kpa = number(parts[0]);
    material.poisson = number(parts[1]);
  }

  /// Tetrahedra first, each kind by its numbers; regions are the sets that elements were given in.
  void finish() {
    if (!m_pending.empty()) fail("the end of the file", "the other nodes of an element");
    for (const Element& element : m_elements) {
      m_last_region = std::max(m_last_region, region_in(element.set));
    }
    std::stable_sort(m_elements.begin(), m_elements.end(), [](const Element& a, const Element& b) {
      return a.is_tet != b.is_tet ? a.is_tet : a.number < b.number;
    });
    for (std::size_t e = 0; e < m_elements.size(); ++e) {
      const Element& element = m_elements[e];
      const auto& n = element.nodes;
      if (element.is_tet) m_mesh.tets.push_back({n[0], n[1], n[2], n[3]});
      if (!element.is_tet) m_mesh.hexes.push_back(n);
      m_mesh.region_of.push_back(region_of(element.set));
      m_places[element.number] = e;
      m_in_set[element.set].push_back(e);
    }
    take_sections();
    for (const Surface& surface : m_surfaces) take_surface(surface);
  }

  /// The number in the name; names without one count on from the largest.
  std::int32_t region_of(const std::string& set) {
    const std::int32_t region = region_in(set);
    if (region > 0) return region;
    const std::int32_t next = m_last_region + std::int32_t(m_other_regions.size()) + 1;
    return m_other_regions.try_emplace(set, next).first->second;
  }

  /// Elements of a name, a number or a set, ascending, each once.
  std::vector<std::size_t> elements_of(const std::string& name) const {
    std::vector<std::size_t> elements;
    std::vector<std::string> way;
    std::set<std::string> done;
    add_elements(name, elements, way, done);
    std::sort(elements.begin(), elements.end());
    elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
    return elements;
  }

  void add_element(std::int64_t number, std::vector<std::size_t>& elements) const {
    const auto place = m_places.find(number);
    if (place != m_places.end()) elements.push_back(place->second);
  }

  /// `way` holds the sets that led here, `done` those that are in the elements already.
  void add_elements(const std::string& name, std::vector<std::size_t>& elements,
                    std::vector<std::string>& way, std::set<std::string>& done) const {
    if (!name.empty() && std::isdigit(static_cast<unsigned char>(name[0])) != 0) {
      return add_element(whole(name), elements);
    }
    if (std::find(way.begin(), way.end(), name) != way.end() || way.size() == kDeepestSet) {
      fail("*ELSET " + name + " within " + way.back(), "sets without circles");
    }
    if (!done.insert(name).second) return;
    const auto own = m_in_set.find(name);
    if (own != m_in_set.end()) {
      elements.insert(elements.end(), own->second.begin(), own->second.end());
    }
    const auto set = m_sets.find(name);
    if (set == m_sets.end()) return;
    for (const Range& range : set->second.ranges) {
      for (std::int64_t n = 0; n < range.count; ++n) {
        add_element(range.first + n * range.step, elements);
      }
    }
    way.push_back(name);
    for (const std::string& member : set->second.members) add_elements(member, elements, way, done);
    way.pop_back();
  }

  /// Elements of no section have no material.
  void take_sections() {
    if (m_sections.empty()) return;
    m_mesh.material_of.assign(m_mesh.element_count(), -1);
    for (const Section& section : m_sections) {
      const auto material = std::find_if(
          m_mesh.materials.begin(), m_mesh.materials.end(),
          [&](const auto& known) { return upper_case(known.name) == section.material; });
      if (material == m_mesh.materials.end()) {
        fail("*SOLID SECTION of material " + section.material, "a material of the file");
      }
      for (const std::size_t e : elements_of(section.set)) {
        m_mesh.material_of[e] = std::int32_t(material - m_mesh.materials.begin());
      }
    }
  }

  void take_surface(const Surface& surface) {
    FaceSet faces{lower_case(surface.name), {}};
    for (const auto& [name, side] : surface.sides) {
      for (const std::size_t e : elements_of(name)) {
        const bool is_tet = e < m_mesh.tets.size();
        if (side < 0 || side >= (is_tet ? 4 : 6)) continue;
        const auto triangles = triangles_of(m_mesh, {std::int64_t(e), side});
        faces.triangles.insert(faces.triangles.end(), triangles.begin(),
                               triangles.begin() + (is_tet ? 1 : 2));
      }
    }
    if (!faces.triangles.empty()) m_mesh.faces.push_back(std::move(faces));
  }

  const std::string& m_path;
  SolidMesh& m_mesh;
  int m_line = 0;
  Keyword m_keyword;
  std::vector<std::int64_t> m_pending;  // of an element that goes on
  std::unordered_map<std::int64_t, std::int32_t> m_nodes;
  std::vector<Element> m_elements;
  std::map<std::string, Set> m_sets;
  std::vector<Section> m_sections;
  std::vector<Surface> m_surfaces;
  std::unordered_map<std::int64_t, std::size_t> m_places;  // of elements by their number
  std::map<std::string, std::vector<std::size_t>> m_in_set;
  std::int32_t m_last_region = 0;
  std::map<std::string, std::int32_t> m_other_regions;
};

}  // namespace

SolidMesh read_solid_inp(const std::string& path) {
  SolidMesh mesh;
  InpReader(path, mesh).read();
  return mesh;
}

}  // namespace supple
