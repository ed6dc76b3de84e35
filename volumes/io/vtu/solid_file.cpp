#include "volumes/io/vtu/solid_file.h"

#include <charconv>
#include <cstring>
#include <filesystem>

#include "volumes/base/text.h"
#include "volumes/io/bytes/output_file.h"
#include "volumes/io/bytes/text_header.h"

namespace supple {

namespace {

constexpr int kHexahedron = 12;  // VTK's number

/// A length in bytes and the bytes, as one run of base64.
std::string counted_base64(const void* data, std::size_t size) {
  const std::uint64_t length = size;
  std::string bytes(sizeof length + size, '\0');
  std::memcpy(&bytes[0], &length, sizeof length);
  if (size > 0) std::memcpy(&bytes[sizeof length], data, size);
  return base64_of(bytes);
}

std::vector<std::int32_t> whole_numbers(const SolidArray& array) {
  return {array.values.begin(), array.values.end()};
}

class VtuWriter {
 public:
  explicit VtuWriter(const std::string& path) : m_file(path) {}

  void write(const HexSolid& solid, Progress* progress) {
    m_file.write(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
        "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece "
        "NumberOfPoints=\"" +
        std::to_string(solid.points_lps_mm.size()) + "\" NumberOfCells=\"" +
        std::to_string(solid.hexahedra.size()) + "\">\n<Points>\n");
    write_array("Float64", "Points", 3, solid.points_lps_mm);
    m_file.write("</Points>\n<Cells>\n");
    write_array("Int32", "connectivity", 1, solid.hexahedra);
    std::vector<std::int64_t> ends(solid.hexahedra.size());
    for (std::size_t n = 0; n < ends.size(); ++n) ends[n] = std::int64_t(8 * (n + 1));
    write_array("Int64", "offsets", 1, ends);
    write_array("UInt8", "types", 1,
                std::vector<std::uint8_t>(solid.hexahedra.size(), kHexahedron));
    m_file.write("</Cells>\n<PointData>\n");
    write_arrays(solid.of_points, progress);
    m_file.write("</PointData>\n<CellData>\n");
    write_arrays(solid.of_cells, progress);
    m_file.write("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
    m_file.close();
    m_file.commit();
  }

 private:
  template <class T>
  void write_array(const std::string& type, const std::string& name, int components,
                   const std::vector<T>& values) {
    m_file.write("<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                 std::to_string(components) + "\" format=\"binary\">\n" +
                 counted_base64(values.data(), values.size() * sizeof(T)) + "\n</DataArray>\n");
  }
  void write_arrays(const std::vector<SolidArray>& arrays, Progress* progress) {
    for (const SolidArray& array : arrays) {
      if (array.are_whole) {
        write_array("Int32", array.name, array.components, whole_numbers(array));
      } else {
        write_array("Float32", array.name, array.components, array.values);
      }
      report(progress, 1);
    }
  }

  OutputFile m_file;
};

/// Text by pieces of about a megabyte.
class LegacyWriter {
 public:
  explicit LegacyWriter(const std::string& path) : m_file(path) {}

  void write(const HexSolid& solid, Progress* progress) {
    const std::size_t points = solid.points_lps_mm.size(), cells = solid.hexahedra.size();
    m_text =
        "# vtk DataFile Version 3.0\nsupple: a deformed body at rest, LPS mm\nASCII\nDATASET "
        "UNSTRUCTURED_GRID\nPOINTS " +
        std::to_string(points) + " double\n";
    for (const Vec3d& point : solid.points_lps_mm) {
      add(point.x, ' ');
      add(point.y, ' ');
      add(point.z, '\n');
    }
    m_text += "CELLS " + std::to_string(cells) + " " + std::to_string(9 * cells) + "\n";
    for (const auto& hexahedron : solid.hexahedra) {
      m_text += "8";
      for (const std::int32_t point : hexahedron) m_text += " " + std::to_string(point);
      add_line_end();
    }
    m_text += "CELL_TYPES " + std::to_string(cells) + "\n";
    for (std::size_t n = 0; n < cells; ++n) {
      m_text += std::to_string(kHexahedron);
      add_line_end();
    }
    m_text += "POINT_DATA " + std::to_string(points) + "\n";
    add_arrays(solid.of_points, progress);
    m_text += "CELL_DATA " + std::to_string(cells) + "\n";
    add_arrays(solid.of_cells, progress);
    m_file.write(m_text);
    m_file.close();
    m_file.commit();
  }

 private:
  template <class T>
  void add(T value, char after) {
    char digits[32];
    m_text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
    if (after == '\n') {
      add_line_end();
    } else {
      m_text += after;
    }
  }
  void add_line_end() {
    m_text += '\n';
    if (m_text.size() < (std::size_t(1) << 20)) return;
    m_file.write(m_text);
    m_text.clear();
  }
  void add_arrays(const std::vector<SolidArray>& arrays, Progress* progress) {
    for (const SolidArray& array : arrays) {
      const std::string type = array.are_whole ? "int" : "float";
      m_text += array.components == 3
                    ? "VECTORS " + array.name + " " + type + "\n"
                    : "SCALARS " + array.name + " " + type + " " +
                          std::to_string(array.components) + "\nLOOKUP_TABLE default\n";
      for (std::size_t n = 0; n < array.values.size(); ++n) {
        const char after = (n + 1) % std::size_t(array.components) == 0 ? '\n' : ' ';
        if (array.are_whole) {
          add(std::int32_t(array.values[n]), after);
        } else {
          add(array.values[n], after);
        }
      }
      report(progress, 1);
    }
  }

  OutputFile m_file;
  std::string m_text;
};

}  // namespace

bool is_solid_name(const std::string& path) {
  const std::string extension = lower_case(std::filesystem::path(path).extension().string());
  return extension == ".vtu" || extension == ".vtk";
}

void write_solid(const std::string& path, const HexSolid& solid, Progress* progress) {
  if (progress != nullptr) progress->stage("writing");
  if (lower_case(std::filesystem::path(path).extension().string()) == ".vtu") {
    VtuWriter(path).write(solid, progress);
  } else {
    LegacyWriter(path).write(solid, progress);
  }
}

}  // namespace supple
