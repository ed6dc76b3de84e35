#include "volumes/io/vtu/solid_file.h"

#include <charconv>
#include <filesystem>

#include "volumes/base/text.h"
#include "volumes/io/bytes/output_file.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/vtu/vtu_writer.h"

namespace supple {

namespace {

constexpr int kHexahedron = 12;  // VTK's number

std::vector<std::int32_t> whole_numbers(const SolidArray& array) {
  return {array.values.begin(), array.values.end()};
}

void write_arrays(const std::string& section, const std::vector<SolidArray>& arrays,
                  VtuWriter& writer, Progress* progress) {
  writer.begin(section);
  for (const SolidArray& array : arrays) {
    if (array.are_whole) {
      writer.write(array.name, array.components, whole_numbers(array));
    } else {
      writer.write(array.name, array.components, array.values);
    }
    report(progress, 1);
  }
  writer.end(section);
}

void write_vtu(const std::string& path, const HexSolid& solid, Progress* progress) {
  const std::size_t cells = solid.hexahedra.size();
  std::vector<std::int32_t> corners;
  corners.reserve(8 * cells);
  for (const auto& cell : solid.hexahedra) corners.insert(corners.end(), cell.begin(), cell.end());
  std::vector<std::int64_t> ends(cells);
  for (std::size_t n = 0; n < cells; ++n) ends[n] = std::int64_t(8 * (n + 1));
  VtuWriter writer(path);
  writer.write_grid(solid.points_lps_mm, corners, ends,
                    std::vector<std::uint8_t>(cells, kHexahedron));
  write_arrays("PointData", solid.of_points, writer, progress);
  write_arrays("CellData", solid.of_cells, writer, progress);
  writer.commit();
}

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
    write_vtu(path, solid, progress);
  } else {
    LegacyWriter(path).write(solid, progress);
  }
}

}  // namespace supple
