// Decks of CalculiX and Abaqus (.inp): *NODE, *ELEMENT with C3D4 and C3D8, sets, *SURFACE,
// *MATERIAL. Source: G. Dhondt, CalculiX CrunchiX user's manual, chapters 6 and 7.
#include <algorithm>
#include <map>

#include "volumes/base/error.h"
#include "volumes/io/solid/element_faces.h"
#include "volumes/io/solid/solid_formats.h"

namespace supple {

namespace {

/// Lines of at most sixteen numbers, as sets have them.
void write_numbers(SolidText& text, const std::vector<std::int64_t>& numbers) {
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    const bool is_last = n + 1 == numbers.size() || (n + 1) % 16 == 0;
    text << numbers[n] << (is_last ? "\n" : ", ");
  }
}

class InpWriter {
 public:
  InpWriter(const std::string& path, const SolidMesh& mesh)
      : m_mesh(mesh), m_groups(solid_groups(mesh)), m_text(path) {}

  void write(Progress* progress) {
    m_text << "** Supple: nodes in mm, LPS; stiffness in kPa, so that forces are in mN\n*NODE, "
              "NSET=all_nodes\n";
    for (std::size_t n = 0; n < m_mesh.nodes_lps_mm.size(); ++n) {
      m_text << n + 1 << ", ";
      m_text.row(m_mesh.nodes_lps_mm[n], ", ") << "\n";
    }
    report(progress, 0.3);
    for (const SolidGroup& group : m_groups) write_elements(group);
    report(progress, 0.7);
    write_region_sets();
    for (const FaceSet& faces : m_mesh.faces) write_faces(faces);
    write_materials();
    m_text.commit();
  }

 private:
  static std::string name_of(const SolidGroup& group) {
    const std::string name = region_name(group.region);
    return group.material < 0 ? name : name + "_material_" + std::to_string(group.material + 1);
  }
  std::int64_t number_of_hex(std::size_t hex) const {
    return std::int64_t(m_mesh.tets.size() + hex + 1);
  }

  void write_elements(const SolidGroup& group) {
    const std::string set = ", ELSET=" + name_of(group) + "\n";
    if (!group.tets.empty()) m_text << "*ELEMENT, TYPE=C3D4" << set;
    for (const std::size_t tet : group.tets) {
      (m_text << tet + 1 << ", ").row(m_mesh.tets[tet], ", ", 1) << "\n";
    }
    if (!group.hexes.empty()) m_text << "*ELEMENT, TYPE=C3D8" << set;
    for (const std::size_t hex : group.hexes) {
      (m_text << number_of_hex(hex) << ", ").row(m_mesh.hexes[hex], ", ", 1) << "\n";
    }
  }

  /// A set for every region; elements without a material are in it already, by their own line.
  void write_region_sets() {
    std::int32_t last = 0;
    bool is_first = true;
    for (const SolidGroup& group : m_groups) {
      if (group.material < 0) continue;
      if (is_first || group.region != last) {
        m_text << "*ELSET, ELSET=" << region_name(group.region) << "\n";
      }
      is_first = false;
      last = group.region;
      m_text << name_of(group) << "\n";
    }
  }

  /// Faces as numbers of faces of elements, and their nodes as a set.
  void write_faces(const FaceSet& faces) {
    const std::string name = word_of(faces.name);
    std::vector<std::int64_t> nodes;
    for (const auto& triangle : faces.triangles) {
      for (const std::int32_t node : triangle) nodes.push_back(node + 1);
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    m_text << "*NSET, NSET=" << name << "_nodes\n";
    write_numbers(m_text, nodes);
    m_text << "*SURFACE, NAME=" << name << ", TYPE=ELEMENT\n";
    for (const ElementSide& side : sides_of(m_mesh, faces)) {
      m_text << side.element + 1 << ", S" << side.side + 1 << "\n";
    }
  }

  void write_materials() {
    for (std::size_t n = 0; n < m_mesh.materials.size(); ++n) {
      const SolidMaterial& material = m_mesh.materials[n];
      m_text << "** " << material.name << "\n*MATERIAL, NAME=material_" << n + 1 << "\n*ELASTIC\n"
             << material.young_kpa << ", " << material.poisson << "\n";
    }
    for (const SolidGroup& group : m_groups) {
      if (group.material < 0) continue;
      m_text << "*SOLID SECTION, ELSET=" << name_of(group) << ", MATERIAL=material_"
             << group.material + 1 << "\n";
    }
  }

  const SolidMesh& m_mesh;
  std::vector<SolidGroup> m_groups;
  SolidText m_text;
};

}  // namespace

void write_solid_inp(const std::string& path, const SolidMesh& mesh, Progress* progress) {
  InpWriter(path, mesh).write(progress);
}

}  // namespace supple
