// Chooses the reader by extension and checks what all of them return.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "volumes/base/error.h"
#include "volumes/io/bytes/byte_source.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/mesh/mesh_contents.h"
#include "volumes/io/mesh/mesh_formats.h"

namespace supple {

namespace {

/// Fewer vertices than an int counts, in every format.
constexpr std::int64_t kMaxFileBytes = std::int64_t(1) << 34;

/// Bytes of the head in which STL, PLY, OBJ and VTK files of 3D Slicer name their frame.
constexpr std::size_t kHeadBytes = 512;

void check_mesh(const std::string& path, const TriangleMesh& mesh) {
  const std::size_t count = mesh.vertices_lps_mm.size();
  for (const auto& triangle : mesh.triangles) {
    for (const int index : triangle) {
      if (index >= 0 && std::size_t(index) < count) continue;
      throw InputError({path, "face", "vertex " + std::to_string(index) + ", counted from 0",
                        "one of " + std::to_string(count) + " vertices"});
    }
  }
  for (std::size_t n = 0; n < count; ++n) {
    const Vec3d& v = mesh.vertices_lps_mm[n];
    if (std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z)) continue;
    throw InputError({path, "vertex " + std::to_string(n) + ", counted from 0",
                      "a coordinate that is not finite", "LPS mm"});
  }
}

void check_lines(const std::string& path, const LineNetwork& network) {
  const std::size_t count = network.mesh.vertices_lps_mm.size();
  for (const auto& line : network.lines) {
    for (const int index : line) {
      if (index >= 0 && std::size_t(index) < count) continue;
      throw InputError({path, "line", "vertex " + std::to_string(index) + ", counted from 0",
                        "one of " + std::to_string(count) + " vertices"});
    }
    if (line[0] != line[1]) continue;
    throw InputError({path, "line", "vertex " + std::to_string(line[0]) + " twice, counted from 0",
                      "two vertices"});
  }
}

std::string mesh_extension(const std::string& path) {
  return lower_case(std::filesystem::path(path).extension().string());
}

TriangleMesh parse(const std::string& path, const std::string& content, MeshSlots* slots,
                   MeshLines* lines) {
  const std::string extension = mesh_extension(path);
  if (extension == ".stl") return read_stl(path, content, slots);
  if (extension == ".ply") return read_ply(path, content, slots, lines);
  if (extension == ".obj") return read_obj(path, content, slots, lines);
  if (extension == ".vtk") return read_vtk(path, content, slots, lines);
  throw InputError({path, "extension", extension.empty() ? "none" : printable(extension),
                    ".stl, .ply, .obj or .vtk"});
}

}  // namespace

std::string read_mesh_content(const std::string& path) {
  const InputFile file(path);
  if (file.size() > kMaxFileBytes) {
    throw InputError({path, "", std::to_string(file.size()) + " bytes",
                      "a mesh of at most " + std::to_string(kMaxFileBytes) + " bytes"});
  }
  std::string content(std::size_t(file.size()), '\0');
  content.resize(file.read_at(0, content.data(), content.size()));
  return content;
}

bool says_ras(const std::string& content) {
  return content.substr(0, kHeadBytes).find("SPACE=RAS") != std::string::npos;
}

TriangleMesh parse_mesh(const std::string& path, const std::string& content, MeshSlots* slots,
                        MeshLines* lines) {
  TriangleMesh mesh = parse(path, content, slots, lines);
  check_mesh(path, mesh);
  if (says_ras(content)) {
    for (Vec3d& v : mesh.vertices_lps_mm) v = {-v.x, -v.y, v.z};
  }
  return mesh;
}

TriangleMesh read_mesh(const std::string& path) {
  TriangleMesh mesh = parse_mesh(path, read_mesh_content(path), nullptr);
  if (mesh.triangles.empty()) throw InputError({path, "mesh", "no triangle", "a surface"});
  return mesh;
}

bool is_mesh_name(const std::string& path) {
  const std::string extension = mesh_extension(path);
  return extension == ".stl" || extension == ".ply" || extension == ".obj" || extension == ".vtk";
}

void MeshContents::take_box(const std::vector<Vec3d>& points_lps_mm) {
  if (points_lps_mm.empty()) return;
  low_lps_mm = high_lps_mm = points_lps_mm.front();
  for (const Vec3d& point : points_lps_mm) {
    for (int a = 0; a < 3; ++a) {
      low_lps_mm[a] = std::min(low_lps_mm[a], point[a]);
      high_lps_mm[a] = std::max(high_lps_mm[a], point[a]);
    }
  }
}

MeshContents mesh_contents(const std::string& path) {
  const std::string content = read_mesh_content(path);
  MeshContents contents;
  const TriangleMesh mesh = parse_mesh(path, content, nullptr);
  contents.format = mesh_extension(path).substr(1);
  contents.points = std::int64_t(mesh.vertices_lps_mm.size());
  contents.cells = std::int64_t(mesh.triangles.size());
  contents.take_box(mesh.vertices_lps_mm);
  if (contents.format == "vtk") add_vtk_contents(path, content, contents);
  return contents;
}

LineNetwork read_network(const std::string& path) {
  LineNetwork network;
  network.mesh = parse_mesh(path, read_mesh_content(path), nullptr, &network.lines);
  check_lines(path, network);
  if (network.lines.empty() && network.mesh.triangles.empty()) {
    throw InputError({path, "network", "neither line nor triangle", "lines or a surface"});
  }
  return network;
}

}  // namespace supple
