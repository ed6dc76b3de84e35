// VTK's XML unstructured grids (.vtu).
#include <cmath>
#include <cstring>
#include <limits>

#include "volumes/base/error.h"
#include "volumes/io/solid/solid_formats.h"
#include "volumes/io/vtu/vtk_xml.h"
#include "volumes/io/vtu/vtu_writer.h"

namespace supple {

namespace {

constexpr int kVtkTet = 10, kVtkVoxel = 11, kVtkHex = 12, kVtkTet10 = 24, kVtkHex20 = 25,
              kVtkHex27 = 29;
constexpr int kMostMaterials = 1'000'000;

/// Elements of all pieces of a file.
class SolidVtuReader {
 public:
  SolidVtuReader(const std::string& path, SolidMesh& mesh) : m_path(path), m_mesh(mesh) {
    open_vtk_xml(path, m_content);
  }

  void read() {
    const pugi::xml_node grid = m_content.xml.child("VTKFile").child("UnstructuredGrid");
    for (const pugi::xml_node& piece : grid.children("Piece")) read_piece(piece);
    m_mesh.region_of = m_tet_regions;
    m_mesh.region_of.insert(m_mesh.region_of.end(), m_hex_regions.begin(), m_hex_regions.end());
    if (!m_has_materials) return;
    m_mesh.material_of = m_tet_materials;
    m_mesh.material_of.insert(m_mesh.material_of.end(), m_hex_materials.begin(),
                              m_hex_materials.end());
  }

 private:
  [[noreturn]] void fail(const std::string& field, const std::string& found,
                         const std::string& expected) const {
    throw InputError({m_path, field, found, expected});
  }

  /// A number of an array, whole and from lo to hi.
  std::int64_t whole(const char* field, double value, std::int64_t lo, std::int64_t hi) const {
    if (!(value >= double(lo) && value <= double(hi)) || value != std::floor(value)) {
      fail(field, number_text(value),
           "a whole number from " + std::to_string(lo) + " to " + std::to_string(hi));
    }
    return std::int64_t(value);
  }

  /// Numbers of an array by its name; none where the section has no such array.
  std::vector<double> numbers(const pugi::xml_node& section, const char* name) const {
    for (const pugi::xml_node& node : section.children("DataArray")) {
      if (std::strcmp(node.attribute("Name").value(), name) == 0) {
        return numbers_of(array_of(node), m_content.encoding);
      }
    }
    return {};
  }

  void read_piece(const pugi::xml_node& piece) {
    const std::size_t first = m_mesh.nodes_lps_mm.size();
    const std::vector<double> places =
        numbers_of(array_of(piece.child("Points").child("DataArray")), m_content.encoding);
    for (std::size_t n = 0; n + 2 < places.size(); n += 3) {
      const Vec3d place(places[n], places[n + 1], places[n + 2]);
      if (!is_finite(place)) {
        fail("Points", "a number that is not finite, of point " + std::to_string(n / 3),
             "finite numbers");
      }
      m_mesh.nodes_lps_mm.push_back(place);
    }
    const pugi::xml_node cells = piece.child("Cells"), data = piece.child("CellData");
    const std::vector<double> corners = numbers(cells, "connectivity"),
                              ends = numbers(cells, "offsets"), types = numbers(cells, "types");
    if (ends.size() != types.size()) {
      fail("types", std::to_string(types.size()), std::to_string(ends.size()) + ", one per cell");
    }
    const std::vector<double> regions = of_cells(data, "region", ends.size()),
                              materials = of_cells(data, "material", ends.size());
    const std::vector<double> young = of_cells(data, "young_kpa", ends.size()),
                              poisson = of_cells(data, "poisson", ends.size());
    m_has_materials |= !materials.empty();
    using Int = std::numeric_limits<std::int32_t>;
    std::int64_t begin = 0;
    for (std::size_t n = 0; n < ends.size(); ++n) {
      const std::int64_t end = whole("offsets", ends[n], begin, std::int64_t(corners.size()));
      const std::int64_t region =
          regions.empty() ? 1 : whole("region", regions[n], Int::min(), Int::max());
      const std::int64_t material =
          materials.empty() ? -1 : whole("material", materials[n], -1, kMostMaterials - 1);
      take_material(material, young.empty() ? 0 : young[n], poisson.empty() ? 0 : poisson[n]);
      add_cell(whole("types", types[n], 0, 255), corners.data() + begin, std::size_t(end - begin),
               first, std::int32_t(region), std::int32_t(material));
      begin = end;
    }
  }

  std::vector<double> of_cells(const pugi::xml_node& data, const char* name,
                               std::size_t cells) const {
    std::vector<double> values = numbers(data, name);
    if (!values.empty() && values.size() != cells) {
      fail(std::string("CellData ") + name, std::to_string(values.size()),
           std::to_string(cells) + ", one per cell");
    }
    return values;
  }

  /// The stiffness of a material, from the first of its cells; -1: none.
  void take_material(std::int64_t material, double young_kpa, double poisson) {
    if (material < 0) return;
    std::vector<SolidMaterial>& materials = m_mesh.materials;
    while (std::int64_t(materials.size()) <= material) {
      materials.push_back({"material_" + std::to_string(materials.size() + 1), 0, 0});
    }
    SolidMaterial& made = materials[std::size_t(material)];
    if (made.young_kpa == 0) made.young_kpa = young_kpa;
    if (made.poisson == 0) made.poisson = poisson;
  }

  void add_cell(std::int64_t type, const double* corners, std::size_t count, std::size_t first,
                std::int32_t region, std::int32_t material) {
    const bool is_tet = type == kVtkTet || type == kVtkTet10;
    const bool is_hex =
        type == kVtkHex || type == kVtkVoxel || type == kVtkHex20 || type == kVtkHex27;
    if (!is_tet && !is_hex) return;
    if (count < (is_tet ? 4U : 8U)) {
      fail("offsets", std::to_string(count) + " corners of a cell of type " + std::to_string(type),
           is_tet ? "4 and more" : "8 and more");
    }
    const std::int64_t points = std::int64_t(m_mesh.nodes_lps_mm.size() - first);
    const auto node = [&](std::size_t c) {
      return std::int32_t(first) + std::int32_t(whole("connectivity", corners[c], 0, points - 1));
    };
    if (is_tet) {
      m_mesh.tets.push_back({node(0), node(1), node(2), node(3)});
      m_tet_regions.push_back(region);
      m_tet_materials.push_back(material);
      return;
    }
    std::array<std::int32_t, 8> hex{};
    for (std::size_t c = 0; c < 8; ++c) {
      hex[c] = node(type == kVtkVoxel ? c ^ (c >> 1 & 1U) : c);  // a voxel's corners go by rows
    }
    m_mesh.hexes.push_back(hex);
    m_hex_regions.push_back(region);
    m_hex_materials.push_back(material);
  }

  std::string m_path;
  SolidMesh& m_mesh;
  VtkXml m_content;
  bool m_has_materials = false;
  std::vector<std::int32_t> m_tet_regions, m_hex_regions, m_tet_materials, m_hex_materials;
};

}  // namespace

void write_solid_vtu(const std::string& path, const SolidMesh& mesh, Progress* progress) {
  std::vector<std::int32_t> corners;
  std::vector<std::int64_t> ends;
  std::vector<std::uint8_t> types;
  corners.reserve(4 * mesh.tets.size() + 8 * mesh.hexes.size());
  const auto add = [&](const auto& cell, int type) {
    corners.insert(corners.end(), cell.begin(), cell.end());
    ends.push_back(std::int64_t(corners.size()));
    types.push_back(std::uint8_t(type));
  };
  for (const auto& tet : mesh.tets) add(tet, kVtkTet);
  for (const auto& hex : mesh.hexes) add(hex, kVtkHex);
  VtuWriter writer(path);
  writer.write_grid(mesh.nodes_lps_mm, corners, ends, types);
  report(progress, 0.5);
  writer.begin("CellData");
  if (!mesh.region_of.empty()) writer.write("region", 1, mesh.region_of);
  if (!mesh.material_of.empty()) {
    writer.write("material", 1, mesh.material_of);
    const SolidMaterial none;
    std::vector<float> young, poisson;
    for (const std::int32_t material : mesh.material_of) {
      const SolidMaterial& own = material < 0 ? none : mesh.materials[std::size_t(material)];
      young.push_back(float(own.young_kpa));
      poisson.push_back(float(own.poisson));
    }
    writer.write("young_kpa", 1, young);
    writer.write("poisson", 1, poisson);
  }
  writer.end("CellData");
  writer.commit();
}

SolidMesh read_solid_vtu(const std::string& path) {
  SolidMesh mesh;
  SolidVtuReader(path, mesh).read();
  return mesh;
}

}  // namespace supple
