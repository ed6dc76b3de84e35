#include "volumes/io/vtu/vtu.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include <pugixml.hpp>

#include "volumes/base/error.h"
#include "volumes/io/bytes/input_file.h"
#include "volumes/io/vtu/vtu_arrays.h"

namespace supple {

namespace {

/// The whole file, and what is in front of appended data as XML that ends.
struct VtuContent {
  std::string bytes;
  pugi::xml_document xml;
  VtuEncoding encoding;
};

void open_content(const std::string& path, VtuContent& content) {
  const InputFile file(path);
  content.bytes.resize(std::size_t(file.size()));
  file.read_at(0, &content.bytes[0], content.bytes.size());
  VtuEncoding& encoding = content.encoding;
  encoding.path = path;
  const std::size_t appended = content.bytes.find("<AppendedData");
  std::string head = content.bytes.substr(0, appended);
  if (appended != std::string::npos) {
    head += "</VTKFile>";
    const std::size_t end = content.bytes.find('>', appended);
    const std::size_t mark = content.bytes.find('_', std::min(end, content.bytes.size()));
    if (mark == std::string::npos) {
      throw InputError({path, "AppendedData", "no '_' before the data", "a whole file"});
    }
    const std::string tag = content.bytes.substr(appended, end - appended);
    encoding.is_appended_raw = tag.find("base64") == std::string::npos;
    encoding.appended = std::string_view(content.bytes).substr(mark + 1);
  }
  const pugi::xml_parse_result parsed = content.xml.load_buffer(head.data(), head.size());
  if (!parsed) {
    throw InputError(
        {path, "XML",
         std::string(parsed.description()) + " at byte " + std::to_string(parsed.offset),
         "a VTK file of XML"});
  }
  const pugi::xml_node root = content.xml.child("VTKFile");
  const std::string compressor = root.attribute("compressor").value();
  encoding.is_compressed = !compressor.empty();
  encoding.is_big_endian = std::string(root.attribute("byte_order").value()) == "BigEndian";
  encoding.is_header_64 = std::string(root.attribute("header_type").value()) == "UInt64";
  if (encoding.is_compressed && compressor != "vtkZLibDataCompressor") {
    throw InputError({path, "compressor", compressor, "vtkZLibDataCompressor, or none"});
  }
}

VtuArray array_of(const pugi::xml_node& node) {
  VtuArray array;
  array.name = node.attribute("Name").value();
  array.type = node.attribute("type").value();
  array.format = node.attribute("format").value();
  array.text = node.text().get();
  array.offset = node.attribute("offset").as_llong(-1);
  return array;
}

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
  // Of a hexahedron the six around the diagonal from corner 0 to corner 6.
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

}  // namespace

bool is_vtu(const std::string& head) {
  const std::size_t tag = head.find("<VTKFile");
  if (tag == std::string::npos) return false;
  return head.find("\"UnstructuredGrid\"", tag) != std::string::npos;
}

MovedSolid read_vtu(const std::string& path) {
  VtuContent content;
  open_content(path, content);
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
