#include "lib/fem/tet/tet_volumes.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr std::array<std::array<std::size_t, 2>, 6> kEdges{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

/// Four points, exact for polynomials of degree 2 (Hammer & Stroud 1956).
constexpr double kNear = 0.58541019662496845446, kFar = 0.13819660112501051518;
constexpr std::array<std::array<double, 4>, 4> kPoints{{{kNear, kFar, kFar, kFar},
                                                        {kFar, kNear, kFar, kFar},
                                                        {kFar, kFar, kNear, kFar},
                                                        {kFar, kFar, kFar, kNear}}};
constexpr std::array<double, 4> kCentre{0.25, 0.25, 0.25, 0.25};

[[noreturn]] void refuse(std::size_t element, const std::string& found,
                         const std::string& expected) {
  throw InputError({"", "tetrahedron " + std::to_string(element), found, expected});
}

/// 420 / (rho V) times the consistent mass between two of ten nodes.
double quadratic_mass(std::size_t a, std::size_t b) {
  if (a > b) std::swap(a, b);
  if (b < 4) return a == b ? 6 : 1;
  const auto [c, d] = kEdges[b - 4];
  if (a < 4) return a == c || a == d ? -4 : -6;
  const auto [e, f] = kEdges[a - 4];
  if (a == b) return 32;
  return c == e || c == f || d == e || d == f ? 16 : 8;
}

void add_diagonal(double value, Matrix9& block) {
  for (std::size_t m = 0; m < 3; ++m) block[4 * m] += value;
}

double determinant(const Matrix9& a) {
  return determinant_of(a, cofactors(a));
}

Matrix9 deformation_of(Matrix9 gradient) {
  for (std::size_t m = 0; m < 3; ++m) gradient[4 * m] += 1;
  return gradient;
}

}  // namespace

TetVolumes::TetVolumes(const SolidMesh& mesh, TetElement element)
    : m_element(element), m_positions(mesh.nodes_lps_mm), m_material_of(mesh.material_of) {
  if (!mesh.hexes.empty()) {
    throw InputError(
        {"", "mesh", std::to_string(mesh.hexes.size()) + " hexahedra", "tetrahedra alone"});
  }
  if (m_material_of.empty()) m_material_of.assign(mesh.tets.size(), 0);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    const std::array<std::int32_t, 4>& at = mesh.tets[e];
    for (const std::int32_t node : at) {
      if (node >= 0 && std::size_t(node) < m_positions.size()) continue;
      refuse(e, "node " + std::to_string(node),
             "0 to " + std::to_string(std::int64_t(m_positions.size()) - 1));
    }
    const auto corner = [&](std::size_t n) { return m_positions[std::size_t(at[n])]; };
    m_shapes.push_back(tet_shape(corner(0), corner(1), corner(2), corner(3)));
    const double volume = m_shapes.back().volume_mm3;
    if (!(volume > 0)) refuse(e, number_text(volume) + " mm³", "a volume above 0");
    m_elements.add(at.data(), 4);
  }
  if (element == TetElement::quadratic) make_middles();
  if (element == TetElement::nodal_pressure) make_patches();
}

void TetVolumes::make_middles() {
  for (std::size_t e = 0; e < m_shapes.size(); ++e) {
    for (const auto& [a, b] : kEdges) {
      const NodeIndex from = m_elements.nodes(e)[a], to = m_elements.nodes(e)[b];
      m_middles.push_back({std::min(from, to), std::max(from, to), -1});
    }
  }
  std::sort(m_middles.begin(), m_middles.end());
  m_middles.erase(std::unique(m_middles.begin(), m_middles.end()), m_middles.end());
  for (auto& [a, b, middle] : m_middles) {
    middle = NodeIndex(m_positions.size());
    m_positions.push_back((m_positions[std::size_t(a)] + m_positions[std::size_t(b)]) / 2);
  }
  NodeSets ten;
  for (std::size_t e = 0; e < m_shapes.size(); ++e) {
    const NodeIndex* corner = m_elements.nodes(e);
    std::array<NodeIndex, 10> nodes{corner[0], corner[1], corner[2], corner[3]};
    for (std::size_t n = 0; n < 6; ++n) {
      nodes[4 + n] = middle_of(corner[kEdges[n][0]], corner[kEdges[n][1]]);
    }
    ten.add(nodes.data(), 10);
  }
  m_elements = std::move(ten);
}

NodeIndex TetVolumes::middle_of(NodeIndex a, NodeIndex b) const {
  const std::array<NodeIndex, 3> wanted{std::min(a, b), std::max(a, b), -1};
  const auto found = std::lower_bound(m_middles.begin(), m_middles.end(), wanted);
  const bool is_there =
      found != m_middles.end() && (*found)[0] == wanted[0] && (*found)[1] == wanted[1];
  return is_there ? (*found)[2] : -1;
}

void TetVolumes::make_patches() {
  const SetsOfNodes of_node(m_positions.size(), m_elements);
  m_patch.of_element.resize(m_shapes.size());
  m_patch.begin.push_back(0);
  std::vector<std::pair<std::int32_t, SetsOfNodes::Place>> around;  // by material
  for (std::size_t node = 0; node < m_positions.size(); ++node) {
    around.clear();
    for (std::int32_t n = of_node.begin[node]; n < of_node.begin[node + 1]; ++n) {
      const SetsOfNodes::Place place = of_node.places[std::size_t(n)];
      around.emplace_back(m_material_of[std::size_t(place.set)], place);
    }
    std::stable_sort(around.begin(), around.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (auto first = around.begin(); first != around.end();) {
      const auto last = std::find_if(first, around.end(),
                                     [&](const auto& of) { return of.first != first->first; });
      std::vector<NodeIndex> nodes;
      for (auto it = first; it != last; ++it) {
        const NodeIndex* corners = m_elements.nodes(std::size_t(it->second.set));
        nodes.insert(nodes.end(), corners, corners + 4);
      }
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
      std::vector<Vec3d> gradients(nodes.size(), Vec3d(0));
      double volume = 0;
      for (auto it = first; it != last; ++it) {
        const std::size_t e = std::size_t(it->second.set);
        const double quarter = m_shapes[e].volume_mm3 / 4;
        volume += quarter;
        for (std::size_t c = 0; c < 4; ++c) {
          const auto at = std::lower_bound(nodes.begin(), nodes.end(), m_elements.nodes(e)[c]);
          gradients[std::size_t(at - nodes.begin())] += m_shapes[e].gradient[c] * quarter;
        }
        m_patch.of_element[e][std::size_t(it->second.at)] = std::int32_t(m_patches.size());
      }
      m_patches.add(nodes.data(), nodes.size());
      m_patch.material_of.push_back(first->first);
      m_patch.volume_mm3.push_back(volume);
      m_patch.gradients.insert(m_patch.gradients.end(), gradients.begin(), gradients.end());
      m_patch.begin.push_back(m_patch.gradients.size());
      first = last;
    }
  }
}

void TetVolumes::add_to(BlockCsr& matrix, const std::vector<TetModuli>& of_material) const {
  if (m_element == TetElement::quadratic) {
    add_quadratic(matrix, of_material);
  } else {
    add_linear(matrix, of_material);
    if (m_element == TetElement::nodal_pressure) add_patches(matrix, of_material);
  }
}

void TetVolumes::add_linear(BlockCsr& matrix, const std::vector<TetModuli>& of_material) const {
  const bool is_averaged = m_element == TetElement::nodal_pressure;
  matrix.add_sets(m_elements, [&](std::size_t e, std::int32_t a, Matrix9* blocks) {
    const TetModuli& moduli = of_material[std::size_t(m_material_of[e])];
    const TetShape& shape = m_shapes[e];
    const double volume = shape.volume_mm3;
    const double lambda = is_averaged ? std::min(0.0, moduli.lambda_kpa()) : moduli.lambda_kpa();
    for (std::size_t b = 0; b < 4; ++b) {
      blocks[b] = Matrix9{};
      add_stiffness(volume * lambda, volume * moduli.shear_kpa, shape.gradient[std::size_t(a)],
                    shape.gradient[b], blocks[b]);
      add_diagonal(moduli.inertia * volume / 20 * (std::size_t(a) == b ? 2 : 1), blocks[b]);
    }
  });
}

void TetVolumes::add_patches(BlockCsr& matrix, const std::vector<TetModuli>& of_material) const {
  matrix.add_sets(m_patches, [&](std::size_t p, std::int32_t a, Matrix9* blocks) {
    const double lambda = of_material[std::size_t(m_patch.material_of[p])].nodal_kpa();
    const double weight = lambda / m_patch.volume_mm3[p];
    const Vec3d* gradients = m_patch.gradients.data() + m_patch.begin[p];
    for (std::size_t b = 0; b < m_patches.count(p); ++b) {
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          blocks[b][3 * std::size_t(i) + std::size_t(j)] =
              weight * (gradients[a][i] * gradients[b][j]);
        }
      }
    }
  });
}

void TetVolumes::add_quadratic(BlockCsr& matrix, const std::vector<TetModuli>& of_material) const {
  matrix.add_sets(m_elements, [&](std::size_t e, std::int32_t row, Matrix9* blocks) {
    const TetModuli& moduli = of_material[std::size_t(m_material_of[e])];
    const std::size_t a = std::size_t(row);
    const double volume = m_shapes[e].volume_mm3;
    for (std::size_t b = 0; b < 10; ++b) {
      blocks[b] = Matrix9{};
      add_diagonal(moduli.inertia * volume / 420 * quadratic_mass(a, b), blocks[b]);
    }
    for (const Bary& point : kPoints) {
      const std::array<Vec3d, 10> gradients = gradients_at(e, point);
      for (std::size_t b = 0; b < 10; ++b) {
        add_stiffness(volume / 4 * moduli.lambda_kpa(), volume / 4 * moduli.shear_kpa, gradients[a],
                      gradients[b], blocks[b]);
      }
    }
  });
}

/// Gradients of L (2 L - 1) at corners and of 4 L_a L_b at middles; the first four are those of the
/// linear element where there are no more.
std::array<Vec3d, 10> TetVolumes::gradients_at(std::size_t element, const Bary& at) const {
  const std::array<Vec3d, 4>& gradient = m_shapes[element].gradient;
  std::array<Vec3d, 10> out;
  if (m_element != TetElement::quadratic) {
    std::copy(gradient.begin(), gradient.end(), out.begin());
    return out;
  }
  for (std::size_t c = 0; c < 4; ++c) out[c] = gradient[c] * (4 * at[c] - 1);
  for (std::size_t n = 0; n < 6; ++n) {
    const auto [a, b] = kEdges[n];
    out[4 + n] = gradient[a] * (4 * at[b]) + gradient[b] * (4 * at[a]);
  }
  return out;
}

std::array<Vec3d, 10> TetVolumes::point_gradients(std::size_t element, std::size_t point) const {
  return gradients_at(element, point_count() == 1 ? kCentre : kPoints[point]);
}

Matrix9 TetVolumes::gradient_at(std::size_t element, const Bary& at,
                                const std::vector<double>& u_mm) const {
  const std::array<Vec3d, 10> gradients = gradients_at(element, at);
  Matrix9 out{};
  for (std::size_t n = 0; n < m_elements.count(element); ++n) {
    const double* u = &u_mm[3 * std::size_t(m_elements.nodes(element)[n])];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j)
        out[3 * std::size_t(i) + std::size_t(j)] += u[i] * gradients[n][j];
    }
  }
  return out;
}

Matrix9 TetVolumes::gradient_at_centre(std::size_t element, const std::vector<double>& u_mm) const {
  return gradient_at(element, kCentre, u_mm);
}

void TetVolumes::add_swelling(const std::vector<double>& pressure_kpa,
                              std::vector<double>& force_mn) const {
  // The mean gradient of a quadratic shape function is that at the centre.
  for (std::size_t e = 0; e < m_shapes.size(); ++e) {
    const double weight = pressure_kpa[e] * m_shapes[e].volume_mm3;
    if (weight == 0) continue;
    const std::array<Vec3d, 10> gradients = gradients_at(e, kCentre);
    for (std::size_t n = 0; n < m_elements.count(e); ++n) {
      double* force = &force_mn[3 * std::size_t(m_elements.nodes(e)[n])];
      for (int a = 0; a < 3; ++a) force[a] += weight * gradients[n][a];
    }
  }
}

void TetVolumes::add_body_force(const std::vector<Vec3d>& mn_per_mm3,
                                std::vector<double>& force_mn) const {
  const bool is_quadratic = m_element == TetElement::quadratic;
  for (std::size_t e = 0; e < m_shapes.size(); ++e) {
    const Vec3d whole = mn_per_mm3[std::size_t(m_material_of[e])] * m_shapes[e].volume_mm3;
    for (std::size_t n = 0; n < m_elements.count(e); ++n) {
      const double share = !is_quadratic ? 0.25 : n < 4 ? -0.05 : 0.2;
      double* force = &force_mn[3 * std::size_t(m_elements.nodes(e)[n])];
      for (int a = 0; a < 3; ++a) force[a] += share * whole[a];
    }
  }
}

std::vector<double> TetVolumes::patch_dilatations(const std::vector<double>& u_mm) const {
  std::vector<double> out(m_patches.size());
  for (std::size_t p = 0; p < out.size(); ++p) {
    for (std::size_t n = 0; n < m_patches.count(p); ++n) {
      const double* u = &u_mm[3 * std::size_t(m_patches.nodes(p)[n])];
      out[p] += m_patch.gradients[m_patch.begin[p] + n].dot(Vec3d(u[0], u[1], u[2]));
    }
    out[p] /= m_patch.volume_mm3[p];
  }
  return out;
}

std::vector<ElementState> TetVolumes::states(const std::vector<double>& u_mm,
                                             const std::vector<TetModuli>& of_material,
                                             const std::vector<double>& pressure_kpa) const {
  const std::vector<double> dilatation = patch_dilatations(u_mm);
  std::vector<ElementState> out(m_shapes.size());
  for (std::size_t e = 0; e < out.size(); ++e) {
    const TetModuli& moduli = of_material[std::size_t(m_material_of[e])];
    const Matrix9 g = gradient_at_centre(e, u_mm);
    ElementState& state = out[e];
    state.strain = {g[0], g[4], g[8], (g[1] + g[3]) / 2, (g[5] + g[7]) / 2, (g[2] + g[6]) / 2};
    state.volume_strain = trace(state.strain);
    double resisted = state.volume_strain;
    if (!dilatation.empty() && moduli.lambda_kpa() > 0) {
      resisted = 0;
      for (const std::int32_t p : m_patch.of_element[e]) resisted += dilatation[std::size_t(p)] / 4;
    }
    const double mean = moduli.lambda_kpa() * resisted;
    for (std::size_t n = 0; n < 6; ++n) {
      state.stress_kpa[n] = 2 * moduli.shear_kpa * state.strain[n] + (n < 3 ? mean : 0);
      state.energy_density_kpa += (n < 3 ? 0.5 : 1) * state.stress_kpa[n] * state.strain[n];
    }
    for (std::size_t n = 0; n < 3 && !pressure_kpa.empty(); ++n) {
      state.stress_kpa[n] -= pressure_kpa[e];
    }
    state.rotation_rad = Vec3d(g[7] - g[5], g[2] - g[6], g[3] - g[1]) / 2;
  }
  return out;
}

double TetVolumes::least_det_f(const std::vector<double>& u_mm) const {
  double least = std::numeric_limits<double>::infinity();
  const auto take = [&](std::size_t e, const Bary& at) {
    least = std::min(least, determinant(deformation_of(gradient_at(e, at, u_mm))));
  };
  for (std::size_t e = 0; e < m_shapes.size(); ++e) {
    take(e, kCentre);
    if (m_element != TetElement::quadratic) continue;
    for (const Bary& point : kPoints) take(e, point);
    for (std::size_t c = 0; c < 4; ++c) {
      Bary corner{};
      corner[c] = 1;
      take(e, corner);
    }
  }
  return least;
}

/// det F is of degree 3 in an element with ten nodes, for which four points are not exact: the
/// volume is that of its eight linear parts where edges stay straight, and nearly so elsewhere.
double TetVolumes::displaced_volume_mm3(const std::vector<double>& u_mm) const {
  double sum = 0;
  for (std::size_t e = 0; e < m_shapes.size(); ++e) {
    double mean = 0;
    if (m_element == TetElement::quadratic) {
      for (const Bary& point : kPoints) {
        mean += determinant(deformation_of(gradient_at(e, point, u_mm))) / 4;
      }
    } else {
      mean = determinant(deformation_of(gradient_at_centre(e, u_mm)));
    }
    sum += m_shapes[e].volume_mm3 * mean;
  }
  return sum;
}

std::size_t TetVolumes::bytes() const {
  return m_positions.capacity() * sizeof(Vec3d) + m_shapes.capacity() * sizeof(TetShape) +
         m_material_of.capacity() * sizeof(std::int32_t) + m_elements.bytes() + m_patches.bytes() +
         m_patch.gradients.capacity() * sizeof(Vec3d) + m_patch.of_element.capacity() * 16 +
         m_patch.volume_mm3.capacity() * sizeof(double) +
         m_patch.begin.capacity() * sizeof(std::size_t) +
         m_patch.material_of.capacity() * sizeof(std::int32_t) + m_middles.capacity() * 12;
}

}  // namespace supple
