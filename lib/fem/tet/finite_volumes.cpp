#include "lib/fem/tet/finite_volumes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

constexpr Grain kElements{256};

/// det(1 + H) - 1 without the cancellation of small H.
double volume_change_of(const Matrix9& h) {
  const double minors =
      h[0] * h[4] - h[1] * h[3] + h[4] * h[8] - h[5] * h[7] + h[8] * h[0] - h[6] * h[2];
  return h[0] + h[4] + h[8] + minors + determinant_of(h, cofactors(h));
}

NodeSets patches_of_elements(const TetVolumes& volumes) {
  NodeSets sets;
  for (const auto& patches : volumes.patch_table().of_element) sets.add(patches.data(), 4);
  return sets;
}

/// Adds weight times the second derivative of det F by rows i and j of F along g and h, where
/// `across` is F (g x h).
void add_second_derivative(double weight, const Vec3d& across, Matrix9& block) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    block[3 * i + j] += weight * across[int(k)];
    block[3 * j + i] -= weight * across[int(k)];
  }
}

}  // namespace

FiniteVolumes::FiniteVolumes(const TetVolumes& volumes, const std::vector<TetModuli>& of_material,
                             std::vector<double> swelling_kpa)
    : m_volumes(&volumes),
      m_of_material(&of_material),
      m_swelling(std::move(swelling_kpa)),
      m_of_node(volumes.positions().size(), volumes.elements()),
      m_of_patch(volumes.patches().size(), patches_of_elements(volumes)) {
  for (const std::int32_t of : volumes.patch_table().material_of) {
    m_nodal.push_back(of_material[std::size_t(of)].nodal_kpa());
  }
}

const TetModuli& FiniteVolumes::moduli(std::size_t element) const {
  return (*m_of_material)[std::size_t(m_volumes->material_of(element))];
}

double FiniteVolumes::own_bulk(std::size_t element) const {
  const TetModuli& of = moduli(element);
  return of.bulk_kpa - (m_nodal.empty() ? 0 : of.nodal_kpa());
}

double FiniteVolumes::swelling(std::size_t element, double part) const {
  return m_swelling.empty() ? 0 : part * m_swelling[element];
}

/// Finds all of an element's points that does not depend on other elements.
void FiniteVolumes::displace(std::size_t element, const double* u_mm, Point* points) const {
  const NodeIndex* nodes = m_volumes->elements().nodes(element);
  const std::size_t count = m_volumes->elements().count(element);
  for (std::size_t p = 0; p < m_volumes->point_count(); ++p) {
    const std::array<Vec3d, 10> gradients = m_volumes->point_gradients(element, p);
    Matrix9 h{};
    for (std::size_t n = 0; n < count; ++n) {
      const double* u = u_mm + 3 * std::size_t(nodes[n]);
      for (std::size_t m = 0; m < 9; ++m) h[m] += u[m / 3] * gradients[n][int(m % 3)];
    }
    Point& out = points[p];
    out.f = h;
    for (std::size_t m = 0; m < 3; ++m) out.f[4 * m] += 1;
    out.cofactor = cofactors(out.f);
    out.volume_change = volume_change_of(h);
    // tr(F^T F) - 3, and J^(-2/3) - 1.
    double excess = 2 * (h[0] + h[4] + h[8]);
    for (const double value : h) excess += value * value;
    const double squared = std::expm1(-2.0 / 3 * std::log1p(out.volume_change));
    const double shear_kpa = moduli(element).shear_kpa, bulk = own_bulk(element);
    out.shear = shear_kpa * (1 + squared);
    out.trace = excess + 3;
    out.pressure_of_shear = out.shear * out.trace / (3 * (out.volume_change + 1));
    out.mean = bulk * out.volume_change - out.pressure_of_shear;
    out.density_kpa = shear_kpa / 2 * (excess * (1 + squared) + 3 * squared) +
                      bulk / 2 * out.volume_change * out.volume_change;
  }
}

void FiniteVolumes::find_dilated(Displaced& out) const {
  out.dilated.resize(m_nodal.size());
  parallel_for(m_nodal.size(), kElements, [&](std::size_t p) {
    double sum = 0;
    for (std::int32_t n = m_of_patch.begin[p]; n < m_of_patch.begin[p + 1]; ++n) {
      const std::size_t e = std::size_t(m_of_patch.places[std::size_t(n)].set);
      sum += m_volumes->volume_mm3(e) / 4 * out.points[e].volume_change;
    }
    out.dilated[p] = sum / m_volumes->patch_table().volume_mm3[p];
  });
}

double FiniteVolumes::mean_over_nodes(std::size_t element,
                                      const std::vector<double>& of_patch) const {
  if (of_patch.empty()) return 0;
  double sum = 0;
  for (const std::int32_t p : m_volumes->patch_table().of_element[element]) {
    sum += of_patch[std::size_t(p)] / 4;
  }
  return sum;
}

FiniteVolumes::Displaced FiniteVolumes::displaced(const double* u_mm, double part) const {
  const std::size_t elements = m_volumes->element_count(), points = m_volumes->point_count();
  Displaced out;
  out.points.resize(elements * points);
  parallel_for(elements, kElements,
               [&](std::size_t e) { displace(e, u_mm, &out.points[e * points]); });
  find_dilated(out);
  std::vector<double> pressure(m_nodal.size());
  for (std::size_t p = 0; p < pressure.size(); ++p) pressure[p] = m_nodal[p] * out.dilated[p];
  parallel_for(elements, kElements, [&](std::size_t e) {
    const double mean = mean_over_nodes(e, pressure) - swelling(e, part);
    for (std::size_t p = 0; p < points; ++p) out.points[e * points + p].mean += mean;
  });
  return out;
}

StrainEnergy FiniteVolumes::add_forces(const double* u_mm, double* force_mn, double part) const {
  const Displaced at = displaced(u_mm, part);
  const std::size_t points = m_volumes->point_count();
  StrainEnergy sum;
  for (std::size_t n = 0; n < at.points.size(); ++n) {
    const Point& of = at.points[n];
    const std::size_t e = n / points;
    const double volume = m_volumes->volume_mm3(e) / double(points);
    sum.energy_uj += volume * (of.density_kpa - swelling(e, part) * of.volume_change);
    // A value that is no number is taken, too.
    if (!(of.volume_change + 1 >= sum.smallest_j)) sum.smallest_j = of.volume_change + 1;
  }
  for (std::size_t p = 0; p < at.dilated.size(); ++p) {
    const double volume = m_volumes->patch_table().volume_mm3[p];
    sum.energy_uj += volume * m_nodal[p] / 2 * at.dilated[p] * at.dilated[p];
  }
  parallel_for(m_of_node.begin.size() - 1, kElements, [&](std::size_t node) {
    Vec3d force(0);
    for (std::int32_t n = m_of_node.begin[node]; n < m_of_node.begin[node + 1]; ++n) {
      const SetsOfNodes::Place place = m_of_node.places[std::size_t(n)];
      const std::size_t e = std::size_t(place.set);
      for (std::size_t p = 0; p < points; ++p) {
        const Point& of = at.points[e * points + p];
        const Vec3d g = m_volumes->point_gradients(e, p)[std::size_t(place.at)];
        force += (times(of.f, g) * of.shear + times(of.cofactor, g) * of.mean) *
                 (m_volumes->volume_mm3(e) / double(points));
      }
    }
    for (int a = 0; a < 3; ++a) force_mn[3 * node + std::size_t(a)] += force[a];
  });
  return sum;
}

/// Adds blocks between one node of an element and all, by the derivative of P along e_j g_b:
///
///   P' = shear D + shear' F + mean' cof F + mean (cof F)'
void FiniteVolumes::add_row(const Point& point, double volume_mm3,
                            const std::array<Vec3d, 10>& gradients, double own_bulk,
                            std::size_t row, std::size_t count, Matrix9* blocks) const {
  const double J = point.volume_change + 1;
  const double both = volume_mm3 * (own_bulk + 5 * point.pressure_of_shear / (3 * J));
  const double mixed = volume_mm3 * 2 * point.shear / (3 * J);
  const Vec3d& g = gradients[row];
  const Vec3d fg = times(point.f, g), cg = times(point.cofactor, g);
  for (std::size_t b = 0; b < count; ++b) {
    const Vec3d& h = gradients[b];
    const Vec3d fh = times(point.f, h), ch = times(point.cofactor, h);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        blocks[b][3 * std::size_t(i) + std::size_t(j)] +=
            both * (cg[i] * ch[j]) - mixed * (fg[i] * ch[j] + cg[i] * fh[j]);
      }
      blocks[b][4 * std::size_t(i)] += volume_mm3 * point.shear * g.dot(h);
    }
    add_second_derivative(volume_mm3 * point.mean, times(point.f, g.cross(h)), blocks[b]);
  }
}

/// Derivatives of J_p V_p by the displacement of each node of a patch.
std::vector<Vec3d> FiniteVolumes::patch_gradients(const Displaced& at) const {
  const TetVolumes::Patches& table = m_volumes->patch_table();
  std::vector<Vec3d> out(table.gradients.size(), Vec3d(0));
  parallel_for(m_nodal.size(), kElements, [&](std::size_t p) {
    const NodeIndex* first = m_volumes->patches().nodes(p);
    const NodeIndex* last = first + m_volumes->patches().count(p);
    for (std::int32_t n = m_of_patch.begin[p]; n < m_of_patch.begin[p + 1]; ++n) {
      const std::size_t e = std::size_t(m_of_patch.places[std::size_t(n)].set);
      const std::array<Vec3d, 10> gradients = m_volumes->point_gradients(e, 0);
      for (std::size_t c = 0; c < 4; ++c) {
        const NodeIndex* node = std::lower_bound(first, last, m_volumes->elements().nodes(e)[c]);
        out[table.begin[p] + std::size_t(node - first)] +=
            times(at.points[e].cofactor, gradients[c]) * (m_volumes->volume_mm3(e) / 4);
      }
    }
  });
  return out;
}

void FiniteVolumes::add_tangent(const double* u_mm, double part, BlockCsr& matrix) const {
  const Displaced at = displaced(u_mm, part);
  const std::size_t points = m_volumes->point_count();
  matrix.add_sets(m_volumes->elements(), [&](std::size_t e, std::int32_t row, Matrix9* blocks) {
    const std::size_t count = m_volumes->elements().count(e);
    std::fill(blocks, blocks + count, Matrix9{});
    for (std::size_t p = 0; p < points; ++p) {
      add_row(at.points[e * points + p], m_volumes->volume_mm3(e) / double(points),
              m_volumes->point_gradients(e, p), own_bulk(e), std::size_t(row), count, blocks);
    }
  });
  if (m_nodal.empty()) return;
  const std::vector<Vec3d> gradients = patch_gradients(at);
  const TetVolumes::Patches& table = m_volumes->patch_table();
  matrix.add_sets(m_volumes->patches(), [&](std::size_t p, std::int32_t row, Matrix9* blocks) {
    const double weight = m_nodal[p] / table.volume_mm3[p];
    const Vec3d* of = gradients.data() + table.begin[p];
    for (std::size_t b = 0; b < m_volumes->patches().count(p); ++b) {
      for (std::size_t m = 0; m < 9; ++m) {
        blocks[b][m] = weight * (of[row][int(m / 3)] * of[b][int(m % 3)]);
      }
    }
  });
}

std::vector<ElementState> FiniteVolumes::states(const std::vector<double>& u_mm) const {
  const Displaced at = displaced(u_mm.data(), 1);
  const std::size_t points = m_volumes->point_count();
  std::vector<double> pressure(m_nodal.size()), energy(m_nodal.size());
  for (std::size_t p = 0; p < m_nodal.size(); ++p) {
    pressure[p] = m_nodal[p] * at.dilated[p];
    energy[p] = pressure[p] * at.dilated[p] / 2;
  }
  std::vector<ElementState> out(m_volumes->element_count());
  parallel_for(out.size(), kElements, [&](std::size_t e) {
    ElementState& state = out[e];
    Matrix9 f{};
    state.volume_strain = 0;
    state.energy_density_kpa = mean_over_nodes(e, energy);
    for (std::size_t p = 0; p < points; ++p) {
      const Point& of = at.points[e * points + p];
      for (std::size_t m = 0; m < 9; ++m) f[m] += of.f[m] / double(points);
      state.volume_strain += of.volume_change / double(points);
      state.energy_density_kpa += of.density_kpa / double(points);
    }
    const double mean = own_bulk(e) * state.volume_strain + mean_over_nodes(e, pressure);
    set_finite(f, moduli(e).shear_kpa, mean - swelling(e, 1), state);
  });
  return out;
}

std::size_t FiniteVolumes::bytes() const {
  const auto bytes_of = [](const SetsOfNodes& sets) {
    return sets.begin.capacity() * sizeof(sets.begin[0]) +
           sets.places.capacity() * sizeof(sets.places[0]);
  };
  return (m_swelling.capacity() + m_nodal.capacity()) * sizeof(double) + bytes_of(m_of_node) +
         bytes_of(m_of_patch);
}

}  // namespace supple
