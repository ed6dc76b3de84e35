#include "volumes/io/mesh/mesh_writer.h"

#include <cstdint>
#include <cstring>
#include <filesystem>

#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/io/bytes/output_file.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/mesh/mesh_contents.h"

namespace supple {

namespace {

template <class Number>
void append(std::string& bytes, Number number) {
  char own[sizeof number];
  std::memcpy(own, &number, sizeof number);
  bytes.append(own, sizeof number);
}

template <class Number>
void append(std::string& bytes, const Vec3d& v) {
  for (int c = 0; c < 3; ++c) append(bytes, Number(v[c]));
}

std::string text_of(const Vec3d& v) {
  return exact_text(v.x) + " " + exact_text(v.y) + " " + exact_text(v.z) + "\n";
}

/// Indices from `first` on, one cell per line.
template <class Cells>
std::string lines_of(const Cells& cells, const std::string& before, int first) {
  std::string text;
  for (const auto& cell : cells) {
    text += before;
    for (const int node : cell) text += " " + std::to_string(node + first);
    text += "\n";
  }
  return text;
}

std::string stl_of(const TriangleMesh& mesh) {
  std::string bytes = "Supple, SPACE=LPS, mm";
  bytes.resize(80, ' ');
  append(bytes, std::uint32_t(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    const Vec3d& a = mesh.vertices_lps_mm[std::size_t(triangle[0])];
    const Vec3d& b = mesh.vertices_lps_mm[std::size_t(triangle[1])];
    const Vec3d& c = mesh.vertices_lps_mm[std::size_t(triangle[2])];
    const Vec3d across = (b - a).cross(c - a);
    const double length = across.length();
    append<float>(bytes, length > 0 ? across / length : Vec3d(0));
    for (const Vec3d* corner : {&a, &b, &c}) append<float>(bytes, *corner);
    append(bytes, std::uint16_t(0));
  }
  return bytes;
}

std::string ply_of(const LineNetwork& network) {
  const TriangleMesh& mesh = network.mesh;
  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment SPACE=LPS, mm\n";
  bytes += "element vertex " + std::to_string(mesh.vertices_lps_mm.size()) +
           "\nproperty double x\nproperty double y\nproperty double z\n";
  bytes += "element face " + std::to_string(mesh.triangles.size()) +
           "\nproperty list uchar int vertex_indices\n";
  if (!network.lines.empty()) {
    bytes += "element edge " + std::to_string(network.lines.size()) +
             "\nproperty int vertex1\nproperty int vertex2\n";
  }
  bytes += "end_header\n";
  for (const Vec3d& vertex : mesh.vertices_lps_mm) append<double>(bytes, vertex);
  for (const auto& triangle : mesh.triangles) {
    append(bytes, std::uint8_t(3));
    for (const int node : triangle) append(bytes, std::int32_t(node));
  }
  for (const auto& line : network.lines) {
    for (const int node : line) append(bytes, std::int32_t(node));
  }
  return bytes;
}

std::string obj_of(const LineNetwork& network) {
  std::string text = "# SPACE=LPS, mm\n";
  for (const Vec3d& vertex : network.mesh.vertices_lps_mm) text += "v " + text_of(vertex);
  return text + lines_of(network.mesh.triangles, "f", 1) + lines_of(network.lines, "l", 1);
}

template <class Cells>
std::string vtk_cells(const char* name, const Cells& cells, std::size_t corners) {
  if (cells.empty()) return {};
  return name + (" " + std::to_string(cells.size())) + " " +
         std::to_string(cells.size() * (corners + 1)) + "\n" +
         lines_of(cells, std::to_string(corners), 0);
}

std::string vtk_of(const LineNetwork& network) {
  const TriangleMesh& mesh = network.mesh;
  std::string text = "# vtk DataFile Version 3.0\nSupple, SPACE=LPS, mm\nASCII\nDATASET POLYDATA\n";
  text += "POINTS " + std::to_string(mesh.vertices_lps_mm.size()) + " double\n";
  for (const Vec3d& vertex : mesh.vertices_lps_mm) text += text_of(vertex);
  return text + vtk_cells("LINES", network.lines, 2) + vtk_cells("POLYGONS", mesh.triangles, 3);
}

std::string extension_of(const std::string& path) {
  return lower_case(std::filesystem::path(path).extension().string());
}

std::string bytes_of(const std::string& path, const LineNetwork& network) {
  const std::string extension = extension_of(path);
  if (extension == ".ply") return ply_of(network);
  if (extension == ".obj") return obj_of(network);
  if (extension == ".vtk") return vtk_of(network);
  if (network.mesh.triangles.empty()) {
    throw InputError({path, "mesh", "a network without triangles", "a .ply, .obj or .vtk file"});
  }
  return stl_of(network.mesh);
}

}  // namespace

void require_mesh_name(const std::string& path, const std::string& place,
                       const std::string& field) {
  if (is_mesh_name(path)) return;
  throw InputError({place, field, path, ".stl, .ply, .obj or .vtk"});
}

void write_mesh(const std::string& path, const LineNetwork& network) {
  require_mesh_name(path, path, "extension");
  OutputFile file(path);
  file.write(bytes_of(path, network));
  file.close();
  file.commit();
}

}  // namespace supple
