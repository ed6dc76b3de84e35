#include "volumes/io/vtu/vtu.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include "volumes/base/error.h"
#include "volumes/io/vtu/vtk_xml.h"

namespace supple {

namespace {

std::vector<Vec3d> vectors_of(const pugi::xml_node& node, const VtuEncoding& encoding) {
  const std::vector<double> numbers = numbers_of(array_of(node), encoding);
  std::vector<Vec3d> vectors(numbers.size() / 3);
  for (std::size_t n = 0; n < vectors.size(); ++n) {
    vectors[n] = {numbers[3 * n], numbers[3 * n + 1], numbers[3 * n + 2]};
    if (std::isfinite(vectors[n].x) && std::isfinite(vectors[n].y) && std::isfinite(vectors[n].z))
      continue;
    throw InputError({encoding.path, std::string("DataArray ") + node.attribute("Name").value(),
                      "a number that is not finite, of point " + std::to_string(n),
                      "finite numbers"});
  }
  return vectors;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

/// The array that says where points have gone.
pugi::xml_node displacement_array(const pugi::xml_node& piece, const std::string& path) {
  std::vector<pugi::xml_node> triples;
  std::string names;
  for (const pugi::xml_node& node : piece.child("PointData").children("DataArray")) {
    const std::string name = node.attribute("Name").value();
    names += (names.empty() ? "" : ", ") + name;
    if (node.attribute("NumberOfComponents").as_int(1) != 3) continue;
    const std::string known[] = {"displacement", "displacements", "disp", "u"};
    if (std::find(std::begin(known), std::end(known), lower(name)) != std::end(known)) return node;
    triples.push_back(node);
  }
  if (triples.size() == 1) return triples.front();
  throw InputError({path, "PointData", names.empty() ? "no array" : names,
                    "an array of three components named displacement, disp or u"});
}

/// The tetrahedra of a cell by its VTK number, by its corners.
std::vector<std::array<int, 4>> split_cell(int type, const std::vector<int>& c) {
  const auto corner = [&](const std::vector<std::array<int, 4>>& tetrahedra) {
    std::vector<std::array<int, 4>> split = tetrahedra;
    for (auto& tetrahedron : split) {
      for (int& n : tetrahedron) n = c[std::size_t(n)];
    }
    return split;
  };
  const auto holds = [&](std::size_t corners) { return c.size() >= corners; };
  // The six tetrahedra of a hexahedron around its diagonal from corner 0 to corner 6.
  const std::vector<std::array<int, 4>> hexahedron = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6},
                                                      {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
  const std::vector<std::array<int, 4>> voxel = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                                 {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  switch (type) {
    case 10:  // and quadratic
    case 24:
      return holds(4) ? corner({{0, 1, 2, 3}}) : corner({});
    case 11:
      return holds(8) ? corner(voxel) : corner({});
    case 12:
    case 25:
    case 29:
      return holds(8) ? corner(hexahedron) : corner({});
    case 13:
    case 26:
      return holds(6) ? corner({{0, 1, 2, 3}, {1, 2, 3, 4}, {2, 3, 4, 5}}) : corner({});
    case 14:
    case 27:
      return holds(5) ? corner({{0, 1, 2, 4}, {0, 2, 3, 4}}) : corner({});
    default:
      return {};
  }
}

class VtuPiece {
 public:
  VtuPiece(const pugi::xml_node& piece, const VtuEncoding& encoding)
      : m_piece(piece), m_encoding(encoding) {}

  void add_to(MovedSolid& solid) const {
    const int first = int(solid.points_lps_mm.size());
    const auto points = vectors_of(m_piece.child("Points").child("DataArray"), m_encoding);
    const auto moved = vectors_of(displacement_array(m_piece, m_encoding.path), m_encoding);
    if (moved.size() != points.size()) {
      fail("PointData", std::to_string(moved.size()) + " vectors",
           std::to_string(points.size()) + ", one per point");
    }
    solid.points_lps_mm.insert(solid.points_lps_mm.end(), points.begin(), points.end());
    solid.moved_mm.insert(solid.moved_mm.end(), moved.begin(), moved.end());
    const std::vector<double> ids = cells("connectivity"), ends = cells("offsets"),
                              types = cells("types");
    if (ends.size() != types.size()) {
      fail("types", std::to_string(types.size()), std::to_string(ends.size()) + ", one per cell");
    }
    double begin = 0;
    for (std::size_t n = 0; n < ends.size(); ++n) {
      if (!(ends[n] >= begin && ends[n] <= double(ids.size()))) {
        fail("offsets", number_text(ends[n]), "ascending ends of cells");
      }
      std::vector<int> corners;
      for (auto k = std::size_t(begin); k < std::size_t(ends[n]); ++k) {
        if (!(ids[k] >= 0 && ids[k] < double(points.size()))) {
          fail("connectivity", number_text(ids[k]),
               "a point from 0 to " + std::to_string(points.size() - 1));
        }
        corners.push_back(first + int(ids[k]));
      }
      for (const auto& tetrahedron : split_cell(int(types[n]), corners)) {
        solid.tetrahedra.push_back(tetrahedron);
      }
      begin = ends[n];
    }
  }

 private:
  std::vector<double> cells(const char* name) const {
    for (const pugi::xml_node& node : m_piece.child("Cells").children("DataArray")) {
      if (std::strcmp(node.attribute("Name").value(), name) == 0) {
        return numbers_of(array_of(node), m_encoding);
      }
    }
    fail("Cells", std::string("no ") + name, "connectivity, offsets and types");
  }
  [[noreturn]] void fail(const std::string& field, const std::string& found,
                         const std::string& expected) const {
    throw InputError({m_encoding.path, field, found, expected});
  }

  const pugi::xml_node& m_piece;
  const VtuEncoding& m_encoding;
};

bool is_vtk_xml(const std::string& head, const std::string& type) {
  const std::size_t tag = head.find("<VTKFile");
  return tag != std::string::npos && head.find('"' + type + '"', tag) != std::string::npos;
}

}  // namespace

bool is_vtu(const std::string& head) {
  return is_vtk_xml(head, "UnstructuredGrid");
}

bool is_vti(const std::string& head) {
  return is_vtk_xml(head, "ImageData");
}

MeshContents vtu_contents(const std::string& path) {
  VtkXml content;
  open_vtk_xml(path, content);
  MeshContents contents;
  contents.format = "vtu";
  std::vector<Vec3d> points;
  const auto add_arrays = [&](const pugi::xml_node& data, bool is_of_cells) {
    for (const pugi::xml_node& node : data.children("DataArray")) {
      contents.arrays.push_back({node.attribute("Name").value(),
                                 node.attribute("NumberOfComponents").as_int(1), is_of_cells});
    }
  };
  const pugi::xml_node grid = content.xml.child("VTKFile").child("UnstructuredGrid");
  for (const pugi::xml_node& piece : grid.children("Piece")) {
    const auto of_piece = vectors_of(piece.child("Points").child("DataArray"), content.encoding);
    points.insert(points.end(), of_piece.begin(), of_piece.end());
    contents.cells += piece.attribute("NumberOfCells").as_llong();
    if (!contents.arrays.empty()) continue;  // all pieces have the same
    add_arrays(piece.child("PointData"), false);
    add_arrays(piece.child("CellData"), true);
  }
  contents.points = std::int64_t(points.size());
  contents.take_box(points);
  return contents;
}

MovedSolid read_vtu(const std::string& path) {
  VtkXml content;
  open_vtk_xml(path, content);
  MovedSolid solid;
  const pugi::xml_node grid = content.xml.child("VTKFile").child("UnstructuredGrid");
  for (const pugi::xml_node& piece : grid.children("Piece")) {
    VtuPiece(piece, content.encoding).add_to(solid);
  }
  if (solid.tetrahedra.empty()) {
    throw InputError({path, "Cells", "no solid cell", "tetrahedra, hexahedra, wedges or pyramids"});
  }
  return solid;
}

}  // namespace supple
