// FEBio's models (.feb), specification 4.0: materials, mesh and domains; steps and boundary
// conditions are added in FEBio Studio. Source: FEBio user's manual, "Free Format Input".
#include "volumes/io/solid/solid_formats.h"

namespace supple {

namespace {

std::string part_name(const SolidGroup& group, bool is_tet) {
  std::string name = region_name(group.region);
  if (group.material >= 0) name += "_material_" + std::to_string(group.material + 1);
  return name + (is_tet ? "" : "_hex");
}

template <class Cells>
void write_part(SolidText& text, const char* type, const std::string& name, const Cells& cells,
                const std::vector<std::size_t>& places, std::int64_t& number) {
  if (places.empty()) return;
  text << "    <Elements type=\"" << type << "\" name=\"" << name << "\">\n";
  for (const std::size_t place : places) {
    (text << "      <elem id=\"" << number++ << "\">").row(cells[place], ",", 1) << "</elem>\n";
  }
  text << "    </Elements>\n";
}

void write_materials(SolidText& text, const SolidMesh& mesh) {
  text << "  <Material>\n";
  for (std::size_t n = 0; n < mesh.materials.size(); ++n) {
    text << "    <material id=\"" << n + 1 << "\" name=\"material_" << n + 1
         << "\" type=\"isotropic elastic\">\n      <E>" << mesh.materials[n].young_kpa
         << "</E>\n      <v>" << mesh.materials[n].poisson << "</v>\n    </material>\n";
  }
  text << "  </Material>\n";
}

void write_faces(SolidText& text, const FaceSet& faces) {
  text << "    <Surface name=\"" << word_of(faces.name) << "\">\n";
  for (std::size_t n = 0; n < faces.triangles.size(); ++n) {
    (text << "      <tri3 id=\"" << n + 1 << "\">").row(faces.triangles[n], ",", 1) << "</tri3>\n";
  }
  text << "    </Surface>\n";
}

}  // namespace

void write_solid_feb(const std::string& path, const SolidMesh& mesh, Progress* progress) {
  const std::vector<SolidGroup> groups = solid_groups(mesh);
  SolidText text(path);
  text << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- Supple: nodes in mm, LPS; stiffness in "
          "kPa, forces in mN -->\n<febio_spec version=\"4.0\">\n  <Module type=\"solid\"/>\n";
  if (!mesh.materials.empty()) write_materials(text, mesh);
  text << "  <Mesh>\n    <Nodes name=\"all_nodes\">\n";
  for (std::size_t n = 0; n < mesh.nodes_lps_mm.size(); ++n) {
    text << "      <node id=\"" << n + 1 << "\">";
    text.row(mesh.nodes_lps_mm[n], ",") << "</node>\n";
  }
  text << "    </Nodes>\n";
  report(progress, 0.4);
  std::int64_t number = 1;
  for (const SolidGroup& group : groups) {
    write_part(text, "tet4", part_name(group, true), mesh.tets, group.tets, number);
    write_part(text, "hex8", part_name(group, false), mesh.hexes, group.hexes, number);
  }
  for (const FaceSet& faces : mesh.faces) write_faces(text, faces);
  text << "  </Mesh>\n  <MeshDomains>\n";
  for (const SolidGroup& group : groups) {
    for (const bool is_tet : {true, false}) {
      if ((is_tet ? group.tets : group.hexes).empty()) continue;
      text << "    <SolidDomain name=\"" << part_name(group, is_tet) << "\"";
      if (group.material >= 0) text << " mat=\"material_" << group.material + 1 << "\"";
      text << "/>\n";
    }
  }
  text << "  </MeshDomains>\n</febio_spec>\n";
  text.commit();
}

}  // namespace supple
