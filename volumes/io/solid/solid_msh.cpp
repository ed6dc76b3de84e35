// Gmsh's meshes (.msh), format 2.2 as text, which Gmsh, MFEM, Elmer and meshio read. Regions are
// physical volumes under their number, face sets physical surfaces above them.
// Source: Gmsh reference manual, "Legacy formats: MSH file format version 2".
#include <algorithm>

#include "volumes/io/solid/solid_formats.h"

namespace supple {

namespace {

constexpr int kGmshTriangle = 2, kGmshTet = 4, kGmshHex = 5;

}  // namespace

void write_solid_msh(const std::string& path, const SolidMesh& mesh, Progress* progress) {
  const std::vector<SolidGroup> groups = solid_groups(mesh);
  std::int32_t last_region = 0;
  std::vector<std::int32_t> regions;
  for (const SolidGroup& group : groups) {
    if (regions.empty() || regions.back() != group.region) regions.push_back(group.region);
    last_region = std::max(last_region, group.region);
  }
  SolidText text(path);
  text << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n"
       << regions.size() + mesh.faces.size() << "\n";
  for (std::size_t n = 0; n < mesh.faces.size(); ++n) {
    text << "2 " << last_region + 1 + std::int64_t(n) << " \"" << word_of(mesh.faces[n].name)
         << "\"\n";
  }
  for (const std::int32_t region : regions) {
    text << "3 " << region << " \"" << region_name(region) << "\"\n";
  }
  text << "$EndPhysicalNames\n$Nodes\n" << mesh.nodes_lps_mm.size() << "\n";
  for (std::size_t n = 0; n < mesh.nodes_lps_mm.size(); ++n) {
    (text << n + 1 << " ").row(mesh.nodes_lps_mm[n], " ") << "\n";
  }
  report(progress, 0.4);
  std::size_t elements = mesh.element_count();
  for (const FaceSet& faces : mesh.faces) elements += faces.triangles.size();
  text << "$EndNodes\n$Elements\n" << elements << "\n";
  std::int64_t number = 1;
  const auto write = [&](const auto& cell, int type, std::int64_t physical) {
    text << number++ << " " << type << " 2 " << physical << " " << physical << " ";
    text.row(cell, " ", 1) << "\n";
  };
  for (std::size_t n = 0; n < mesh.faces.size(); ++n) {
    for (const auto& triangle : mesh.faces[n].triangles) {
      write(triangle, kGmshTriangle, last_region + 1 + std::int64_t(n));
    }
  }
  for (const SolidGroup& group : groups) {
    for (const std::size_t tet : group.tets) write(mesh.tets[tet], kGmshTet, group.region);
    for (const std::size_t hex : group.hexes) write(mesh.hexes[hex], kGmshHex, group.region);
  }
  text << "$EndElements\n";
  text.commit();
}

}  // namespace supple
