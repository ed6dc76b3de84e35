// Legacy VTK ("VTK File Formats", The VTK User's Guide, and version 5.1, whose cells are offsets
// and connectivity): a text header, then sections with their numbers as text or big-endian. All
// sections are walked through, so that normals are found wherever they stand; what is attached to
// points and cells is read over.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/mesh/vtk_cells.h"
#include "volumes/io/mesh/vtk_numbers.h"

namespace supple {

namespace {

using namespace vtk;

class VtkReader {
 public:
  VtkReader(const std::string& path, const std::string& content, MeshSlots* slots, MeshLines* lines)
      : m_content(content),
        m_words(path, content),
        m_numbers(content, m_words),
        m_slots(slots),
        m_lines(lines) {}

  TriangleMesh read() {
    read_head();
    for (auto word = m_words.next(); !word.empty(); word = m_words.next()) read_section(word);
    if (!m_has_points) m_words.fail("no points", "a section POINTS");
    if (m_slots != nullptr) add_cell_normals();
    if (!m_types.empty()) add_typed_cells();
    if (m_lines != nullptr) add_lines();
    return std::move(m_mesh);
  }

  /// After read().
  std::int64_t cell_count() const {
    std::size_t count = m_polygons.size() + m_strips.size() + m_cells.size();
    for (const Cells& cells : m_pointlike) count += cells.size();
    return std::int64_t(count);
  }
  const std::vector<MeshArray>& arrays() const { return m_arrays; }

 private:
  void read_head() {
    const auto starts = [&](const char* text) {
      return m_content.compare(0, std::strlen(text), text) == 0;
    };
    const std::string start = "# vtk DataFile Version ";
    if (!starts(start.c_str())) m_words.fail("no VTK header", start + "on the first line");
    m_is_new = m_content.compare(start.size(), 1, "5") >= 0 && starts("# vtk DataFile Version 5");
    m_words.skip_line();
    m_words.skip_line();  // the title
    const std::string encoding = lower_case(std::string(m_words.next()));
    if (encoding != "ascii" && encoding != "binary") m_words.fail(encoding, "ASCII or BINARY");
    m_numbers.set_binary(encoding == "binary");
    m_words.expect("dataset");
    const std::string_view word = m_words.next();
    const std::string kind = lower_case(std::string(word));
    if (kind != "polydata" && kind != "unstructured_grid" && kind != "structured_grid") {
      m_words.fail(word, "POLYDATA, UNSTRUCTURED_GRID or STRUCTURED_GRID");
    }
  }

  void read_section(std::string_view word) {
    const std::string name = lower_case(std::string(word));
    require_once(word, name);
    if (name == "points") return read_points();
    if (name == "dimensions") return m_words.skip_line();
    if (name == "metadata") return skip_metadata();
    if (name == "vertices" || name == "lines") return read_cells(m_pointlike[name == "lines"]);
    if (name == "polygons") return read_polygons();
    if (name == "triangle_strips") return read_strips();
    if (name == "cells") return read_cells(m_cells);
    if (name == "cell_types") return read_cell_types();
    if (name == "point_data" || name == "cell_data") {
      m_is_cell_data = name == "cell_data";
      m_items = std::size_t(m_words.count(m_words.next_on_line()));
      return;
    }
    if (name == "field") return read_field();
    read_attribute(word, name);
  }

  /// Points and cells are numbered from the start of their section.
  void require_once(std::string_view word, const std::string& name) {
    static const std::set<std::string> kNumbered = {
        "points", "vertices", "lines", "polygons", "triangle_strips", "cells", "cell_types"};
    if (kNumbered.count(name) > 0 && !m_numbered.insert(name).second) {
      m_words.fail("a second section " + std::string(word), "one");
    }
  }

  void read_points() {
    const std::size_t count = std::size_t(m_words.count(m_words.next_on_line()));
    const VtkType type = m_numbers.read_type();
    const bool is_real = type.kind == VtkKind::real;
    if (!is_real && m_slots != nullptr) {
      m_words.fail("points of an integer type", "float or double, so that they can move");
    }
    m_words.skip_line();
    m_numbers.require(3 * count, type);
    m_mesh.vertices_lps_mm.resize(count);
    if (m_slots != nullptr) m_slots->positions.resize(count);
    VectorSlot slot;
    for (std::size_t n = 0; n < count; ++n) {
      m_mesh.vertices_lps_mm[n] = m_numbers.read_vector(type, slot);
      if (m_slots != nullptr) m_slots->positions[n] = slot;
    }
    m_has_points = true;
  }

  void read_polygons() {
    read_cells(m_polygons);
    for (std::size_t n = 0; n < m_polygons.size(); ++n) {
      add_polygon(m_polygons.corners(n), m_mesh);
    }
  }
  void read_strips() {
    read_cells(m_strips);
    for (std::size_t n = 0; n < m_strips.size(); ++n) add_strip(m_strips.corners(n), m_mesh);
  }

  void read_cells(Cells& cells) {
    const std::size_t count = std::size_t(m_words.count(m_words.next_on_line()));
    const std::size_t size = std::size_t(m_words.count(m_words.next_on_line()));
    if (m_is_new) return read_offsets(count, size, cells);
    m_words.skip_line();
    m_numbers.require(size, kInt);
    std::size_t left = size;
    for (std::size_t n = 0; n < count; ++n) {
      const double corners = left > 0 ? m_numbers.read_number(kInt) : -1;
      if (!(corners >= 0 && corners <= double(left - 1) && corners == std::floor(corners))) {
        m_words.fail("a cell of " + number_text(corners) + " points", "the points of the section");
      }
      for (int corner = 0; corner < int(corners); ++corner)
        add_id(m_numbers.read_number(kInt), cells);
      cells.ends.push_back(cells.ids.size());
      left -= std::size_t(corners) + 1;
    }
    if (left != 0) m_words.fail("cells that end early", std::to_string(size) + " numbers");
  }

  /// Version 5: the ends of the cells, beginning with 0, and all their points.
  void read_offsets(std::size_t count, std::size_t size, Cells& cells) {
    m_words.expect("offsets");
    const VtkType type = m_numbers.read_type();
    m_words.skip_line();
    m_numbers.require(count, type);
    std::vector<double> offsets(count);
    for (double& offset : offsets) offset = m_numbers.read_number(type);
    m_words.expect("connectivity");
    const VtkType id_type = m_numbers.read_type();
    m_words.skip_line();
    m_numbers.require(size, id_type);
    for (std::size_t n = 0; n < size; ++n) add_id(m_numbers.read_number(id_type), cells);
    for (std::size_t n = 1; n < count; ++n) {
      if (!(offsets[n] >= offsets[n - 1] && offsets[n - 1] >= 0 && offsets[n] <= double(size))) {
        m_words.fail("offset " + number_text(offsets[n]), "ascending ones up to the points");
      }
      cells.ends.push_back(std::size_t(offsets[n]));
    }
  }

  void add_id(double id, Cells& cells) {
    if (!(id >= 0 && id < 2147483647) || id != std::floor(id)) {
      m_words.fail(number_text(id), "the number of a point");
    }
    cells.ids.push_back(int(id));
  }

  void read_cell_types() {
    const std::size_t count = std::size_t(m_words.count(m_words.next_on_line()));
    m_words.skip_line();
    m_numbers.require(count, kInt);
    if (count != m_cells.size()) {
      m_words.fail(std::to_string(count) + " cell types", std::to_string(m_cells.size()));
    }
    for (std::size_t n = 0; n < count; ++n)
      m_types.push_back(std::int64_t(m_numbers.read_number(kInt)));
  }
  void add_typed_cells() {
    for (std::size_t n = 0; n < m_cells.size(); ++n) {
      add_cell(m_types[n], m_cells.corners(n), m_mesh);
    }
  }

  void add_lines() {
    constexpr std::int64_t kLine = 3, kPolyline = 4;
    for (std::size_t n = 0; n < m_pointlike[1].size(); ++n) {
      add_polyline(m_pointlike[1].corners(n), *m_lines);
    }
    for (std::size_t n = 0; n < m_types.size(); ++n) {
      if (m_types[n] != kLine && m_types[n] != kPolyline) continue;
      add_polyline(m_cells.corners(n), *m_lines);
    }
  }

  void read_field() {
    m_words.next_on_line();  // its name
    const std::int64_t arrays = m_words.count(m_words.next_on_line());
    for (std::int64_t n = 0; n < arrays; ++n) {
      std::string name(m_words.next());
      if (lower_case(name) == "metadata") {
        skip_metadata();
        name = m_words.next();
      }
      const std::int64_t components = m_words.count(m_words.next_on_line());
      const std::int64_t tuples = m_words.count(m_words.next_on_line());
      const VtkType type = m_numbers.read_type();
      m_words.skip_line();
      m_arrays.push_back({name, int(components), m_is_cell_data});
      m_numbers.skip(std::size_t(components) * std::size_t(tuples), type);
    }
  }

  void read_attribute(std::string_view word, const std::string& name) {
    static const std::map<std::string, std::size_t> kComponents = {
        {"vectors", 3},    {"tensors", 9},      {"tensors6", 6},
        {"global_ids", 1}, {"pedigree_ids", 1}, {"edge_flags", 1}};
    const auto known = kComponents.find(name);
    const bool is_table = name == "lookup_table", is_colour = name == "color_scalars";
    const bool is_known = known != kComponents.end() || is_table || is_colour ||
                          name == "scalars" || name == "normals" || name == "texture_coordinates";
    if (!is_known) m_words.fail(word, "a section of VTK data");
    const std::string array(m_words.next_on_line());
    if (name == "scalars") return skip_scalars(array);
    if (is_table || is_colour) {
      const std::size_t number = std::size_t(m_words.count(m_words.next_on_line()));
      m_words.skip_line();
      return m_numbers.skip(is_table ? 4 * number : m_items * number,
                            m_numbers.is_binary() ? kByte : kText);
    }
    std::size_t components = known == kComponents.end() ? 3 : known->second;
    if (name == "texture_coordinates") {
      components = std::size_t(m_words.count(m_words.next_on_line()));
    }
    const VtkType type = m_numbers.read_type();
    m_words.skip_line();
    m_arrays.push_back({array, int(components), m_is_cell_data});
    if (name == "normals" && m_slots != nullptr) return read_normals(type);
    m_numbers.skip(components * m_items, type);
  }

  void skip_scalars(const std::string& array) {
    const VtkType type = m_numbers.read_type();
    const std::string_view components = m_words.next_on_line();
    const std::size_t per_item = components.empty() ? 1 : std::size_t(m_words.count(components));
    m_words.skip_line();
    m_arrays.push_back({array, int(per_item), m_is_cell_data});
    // A table is named by old writers and left out by some others.
    if (lower_case(m_content.substr(m_words.position(), 12)) == "lookup_table") m_words.skip_line();
    m_numbers.skip(per_item * m_items, type);
  }

  void read_normals(VtkType type) {
    if (type.kind != VtkKind::real) m_words.fail("normals of an integer type", "float or double");
    m_numbers.require(3 * m_items, type);
    for (std::size_t n = 0; n < m_items; ++n) {
      VectorSlot slot;
      const Vec3d direction = m_numbers.read_vector(type, slot);
      if (m_is_cell_data) {
        m_cell_normals.push_back({slot, direction});
      } else if (n < m_mesh.vertices_lps_mm.size()) {
        m_slots->add_normal(slot, direction, {int(n)});
      }
    }
  }

  /// Cells are counted in this order, whatever that of the sections.
  void add_cell_normals() {
    std::size_t item = 0;
    for (const Cells* cells :
         {&m_pointlike[0], &m_pointlike[1], &m_polygons, &m_strips, &m_cells}) {
      for (std::size_t n = 0; n < cells->size() && item < m_cell_normals.size(); ++n, ++item) {
        const auto& [slot, direction] = m_cell_normals[item];
        m_slots->add_normal(slot, direction, cells->corners(n));
      }
    }
  }

  /// Passes over the lines up to an empty one.
  void skip_metadata() {
    m_words.skip_line();
    while (!m_words.next_on_line().empty()) m_words.skip_line();
  }

  struct CellNormal {
    VectorSlot slot;
    Vec3d direction;
  };

  const std::string& m_content;
  MeshWords m_words;
  VtkNumbers m_numbers;
  MeshSlots* m_slots;
  MeshLines* m_lines;
  TriangleMesh m_mesh;
  std::set<std::string> m_numbered;  // sections so far
  bool m_is_new = false, m_has_points = false, m_is_cell_data = false;
  std::size_t m_items = 0;  // of point or cell data
  Cells m_pointlike[2], m_polygons, m_strips, m_cells;
  std::vector<std::int64_t> m_types;  // of m_cells
  std::vector<CellNormal> m_cell_normals;
  std::vector<MeshArray> m_arrays;
};

}  // namespace

TriangleMesh read_vtk(const std::string& path, const std::string& content, MeshSlots* slots,
                      MeshLines* lines) {
  return VtkReader(path, content, slots, lines).read();
}

void add_vtk_contents(const std::string& path, const std::string& content, MeshContents& contents) {
  VtkReader reader(path, content, nullptr, nullptr);
  reader.read();
  contents.cells = reader.cell_count();
  contents.arrays = reader.arrays();
}

}  // namespace supple
