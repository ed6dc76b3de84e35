#include "lib/fem/tet/tet_fem.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lib/fem/elastic_law.h"
#include "lib/fem/rigid_sight.h"
#include "lib/fem/tet/finite_volumes.h"
#include "lib/fem/tet/tet_system.h"
#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

std::vector<TetModuli> moduli_of(const SolidMesh& mesh) {
  std::vector<TetModuli> out;
  for (const SolidMaterial& material : mesh.materials) {
    const std::string of = "material " + material.name + ", ";
    require(material.young_kpa > 0 && std::isfinite(material.young_kpa), of + "stiffness",
            material.young_kpa, "above 0 kPa");
    require(material.poisson > -1 && material.poisson <= kLargestPoisson, of + "poisson",
            material.poisson, "above -1 and at most 0.4999");
    const ElasticModuli moduli = elastic_moduli(material.young_kpa, material.poisson);
    out.push_back({moduli.shear_kpa, moduli.bulk_kpa, 0});
  }
  return out;
}

void check_materials(const SolidMesh& mesh) {
  const std::size_t count = mesh.tets.size();
  if (!mesh.material_of.empty() && mesh.material_of.size() != count) {
    throw InputError({"", "mesh",
                      std::to_string(mesh.material_of.size()) + " materials of elements",
                      std::to_string(count) + ", one per tetrahedron"});
  }
  if (count > 0 && mesh.materials.empty()) {
    throw InputError({"", "mesh", "no material", "at least one"});
  }
  for (const std::int32_t of : mesh.material_of) {
    if (of >= 0 && std::size_t(of) < mesh.materials.size()) continue;
    throw InputError({"", "mesh", "material " + std::to_string(of),
                      "0 to " + std::to_string(mesh.materials.size() - 1)});
  }
}

const FaceSet& named_set(const std::vector<FaceSet>& faces, const std::string& name) {
  const auto found = std::find_if(faces.begin(), faces.end(),
                                  [&](const FaceSet& set) { return set.name == name; });
  if (found != faces.end()) return *found;
  std::string names;
  for (const FaceSet& set : faces) names += (names.empty() ? "" : ", ") + set.name;
  throw InputError({"", "faces", name, names.empty() ? "a mesh with named faces" : names});
}

/// Triangles between neighbouring nodes: a face itself, or its four parts where its edges have
/// nodes in their middles.
template <class Visit>
void for_each_part(const TetVolumes& volumes, const std::array<std::int32_t, 3>& at,
                   const Visit& visit) {
  const NodeIndex a = at[0], b = at[1], c = at[2];
  const NodeIndex ab = volumes.middle_of(a, b), bc = volumes.middle_of(b, c),
                  ca = volumes.middle_of(c, a);
  using Part = std::array<NodeIndex, 3>;
  if (ab < 0 || bc < 0 || ca < 0) return visit(Part{a, b, c});
  for (const Part& part : {Part{a, ab, ca}, Part{ab, b, bc}, Part{ca, bc, c}, Part{ab, bc, ca}}) {
    visit(part);
  }
}

ShellTriangles shells_of(const SolidMesh& mesh, const TetVolumes& volumes,
                         const std::vector<ElasticSheet>& sheets) {
  std::vector<ShellTriangles::Triangle> triangles;
  for (std::size_t s = 0; s < sheets.size(); ++s) {
    sheets[s].validate();
    for (const auto& face : named_set(mesh.faces, sheets[s].faces).triangles) {
      for_each_part(volumes, face, [&](const std::array<NodeIndex, 3>& part) {
        triangles.push_back({part, std::int32_t(s)});
      });
    }
  }
  return ShellTriangles(sheets, triangles, volumes.positions());
}

void check_faces(const SolidMesh& mesh) {
  for (const FaceSet& set : mesh.faces) {
    for (const auto& triangle : set.triangles) {
      for (const std::int32_t node : triangle) {
        if (node >= 0 && std::size_t(node) < mesh.nodes_lps_mm.size()) continue;
        throw InputError({"", "faces " + set.name, "node " + std::to_string(node),
                          "0 to " + std::to_string(std::int64_t(mesh.nodes_lps_mm.size()) - 1)});
      }
    }
  }
}

const SolidMesh& checked(const SolidMesh& mesh) {
  check_materials(mesh);
  check_faces(mesh);
  return mesh;
}

BlockCsr stiffness_of(const TetVolumes& volumes, const ShellTriangles& shells,
                      const std::vector<TetModuli>& moduli, const std::vector<double>& sheet_parts,
                      const std::vector<double>& sheet_inertia) {
  BlockCsr matrix(volumes.positions().size() + shells.turn_node_count(),
                  {&volumes.elements(), &volumes.patches(), &shells.sets()});
  volumes.add_to(matrix, moduli);
  shells.add_to(matrix, sheet_parts, sheet_inertia);
  return matrix;
}

}  // namespace

TetModel::TetModel(const SolidMesh& mesh, TetElement element, std::vector<ElasticSheet> sheets)
    : m_faces(checked(mesh).faces),
      m_volumes(mesh, element),
      m_moduli(moduli_of(mesh)),
      m_sheets(std::move(sheets)),
      m_shells(shells_of(mesh, m_volumes, m_sheets)),
      m_positions(m_volumes.positions()),
      m_stiffness(stiffness_of(m_volumes, m_shells, m_moduli,
                               std::vector<double>(m_sheets.size(), 1),
                               std::vector<double>(m_sheets.size(), 0))) {
  for (std::size_t n = 0; n < m_shells.turn_node_count(); ++n) {
    const auto [a, b] = m_shells.edges()[3 * n];
    m_positions.push_back((m_positions[std::size_t(a)] + m_positions[std::size_t(b)]) / 2);
  }
  for (std::size_t n = 0; n < m_positions.size(); ++n) {
    const bool is_used = m_stiffness.begin()[n + 1] > m_stiffness.begin()[n] + 1;
    if (is_used) continue;
    throw InputError({"", "mesh", "node " + std::to_string(n) + " of no element or sheet",
                      "nodes of elements alone"});
  }
}

TetModel::~TetModel() = default;

const FaceSet& TetModel::faces_named(const std::string& name) const {
  return named_set(m_faces, name);
}

std::vector<std::array<NodeIndex, 3>> TetModel::parts_of_faces(
    const std::vector<std::string>& names) const {
  std::vector<std::array<NodeIndex, 3>> parts;
  for (const std::string& name : names) {
    for (const auto& face : faces_named(name).triangles) {
      for_each_part(m_volumes, face, [&](const auto& part) { parts.push_back(part); });
    }
  }
  return parts;
}

std::vector<NodeIndex> TetModel::nodes_of_faces(const std::string& name) const {
  std::vector<NodeIndex> nodes;
  for (const auto& part : parts_of_faces({name}))
    nodes.insert(nodes.end(), part.begin(), part.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

double TetModel::area_of(const std::array<NodeIndex, 3>& triangle) const {
  const auto at = [&](std::size_t c) { return m_positions[std::size_t(triangle[c])]; };
  return (at(1) - at(0)).cross(at(2) - at(0)).length() / 2;
}

double TetModel::area_of_faces(const std::string& name) const {
  double sum = 0;
  for (const auto& triangle : faces_named(name).triangles) sum += area_of(triangle);
  return sum;
}

std::vector<ElementState> TetModel::states(const TetSolution& solution,
                                           const TetLoads& loads) const {
  if (solution.strain == StrainTheory::finite) {
    return FiniteVolumes(m_volumes, m_moduli, loads.swelling_kpa).states(solution.u_mm);
  }
  return m_volumes.states(solution.u_mm, m_moduli, loads.swelling_kpa);
}

std::vector<Vec3d> TetModel::node_positions(const std::vector<NodeIndex>& nodes) const {
  std::vector<Vec3d> out;
  for (const NodeIndex node : nodes) out.push_back(m_positions[std::size_t(node)]);
  return out;
}

std::vector<std::array<Vec3d, 3>> TetModel::turn_axes() const {
  std::vector<std::array<Vec3d, 3>> out(m_shells.turn_node_count(), {Vec3d(0), Vec3d(0), Vec3d(0)});
  for (std::size_t e = 0; e < m_shells.edges().size(); ++e) {
    const auto [a, b] = m_shells.edges()[e];
    out[e / 3][e % 3] = (m_positions[std::size_t(b)] - m_positions[std::size_t(a)]).normalized();
  }
  return out;
}

NodePieces TetModel::node_pieces() const {
  NodePieces pieces;
  pieces.of_node.assign(m_positions.size(), -1);
  std::vector<NodeIndex> waiting;
  for (std::size_t n = 0; n < m_positions.size(); ++n) {
    if (pieces.of_node[n] >= 0) continue;
    waiting.push_back(NodeIndex(n));
    pieces.of_node[n] = pieces.count;
    while (!waiting.empty()) {
      const std::size_t row = std::size_t(waiting.back());
      waiting.pop_back();
      for (std::int64_t at = m_stiffness.begin()[row]; at < m_stiffness.begin()[row + 1]; ++at) {
        const NodeIndex other = m_stiffness.columns()[std::size_t(at)];
        if (pieces.of_node[std::size_t(other)] >= 0) continue;
        pieces.of_node[std::size_t(other)] = pieces.count;
        waiting.push_back(other);
      }
    }
    ++pieces.count;
  }
  return pieces;
}

LooseCount TetModel::hold_loose(bool holds, HeldBits& held) const {
  const NodePieces pieces = node_pieces();
  std::vector<RigidSight> sights(std::size_t(pieces.count));
  for (std::size_t n = 0; n < place_count(); ++n) {
    if (held[n] != 0) sights[std::size_t(pieces.of_node[n])].see(m_positions[n], held[n]);
  }
  std::vector<char> is_loose;
  for (const RigidSight& sight : sights) is_loose.push_back(!sight.prevents_all());
  LooseCount count;
  count.islands = pieces.count;
  count.loose_islands = std::count(is_loose.begin(), is_loose.end(), 1);
  const auto loose = [&](NodeIndex n) {
    return is_loose[std::size_t(pieces.of_node[std::size_t(n)])] != 0;
  };
  for (std::size_t e = 0; e < m_volumes.element_count(); ++e) {
    count.loose_elements += loose(m_volumes.elements().nodes(e)[0]);
  }
  for (std::size_t n = 0; n < held.size() && holds; ++n) {
    if (loose(NodeIndex(n))) held[n] = kAllHeld;
  }
  return count;
}

BlockCsr TetModel::weighted_matrix(const ElementWeights& weights) const {
  std::vector<TetModuli> moduli = m_moduli;
  std::vector<double> parts(m_sheets.size()), inertia(m_sheets.size());
  if (moduli.size() + parts.size() > weights.density.size()) {
    throw InputError({"", "mesh",
                      std::to_string(moduli.size() + parts.size()) + " materials and sheets",
                      "at most " + std::to_string(weights.density.size()) + " that have mass"});
  }
  const auto inertia_of = [&](std::size_t of) {
    const double density = weights.density[of];
    require(density > 0 && std::isfinite(density), "density", density, "above 0 kg/m³");
    return weights.mass_part_per_s2 * density * kM3PerMm3;
  };
  for (std::size_t n = 0; n < moduli.size(); ++n) {
    moduli[n].shear_kpa *= weights.stiffness_parts[n];
    moduli[n].bulk_kpa *= weights.stiffness_parts[n];
    moduli[n].inertia = inertia_of(n);
  }
  for (std::size_t n = 0; n < parts.size(); ++n) {
    parts[n] = weights.stiffness_parts[moduli.size() + n];
    inertia[n] = inertia_of(moduli.size() + n);
  }
  return stiffness_of(m_volumes, m_shells, moduli, parts, inertia);
}

std::unique_ptr<Operator> TetModel::weighted(const ElementWeights& weights) const {
  return std::make_unique<BlockCsr>(weighted_matrix(weights));
}

std::unique_ptr<LinearSystem> TetModel::system(const ElementWeights* weights, const HeldBits& held,
                                               Progress* progress) const {
  poll(progress);
  if (weights == nullptr) return std::make_unique<TetSystem>(m_stiffness, held);
  return std::make_unique<TetSystem>(weighted_matrix(*weights), held);
}

std::size_t TetModel::bytes() const {
  return m_volumes.bytes() + m_shells.bytes() + m_stiffness.bytes() +
         m_positions.capacity() * sizeof(Vec3d);
}

}  // namespace supple
