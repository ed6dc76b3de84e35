#include "lib/fem/tet/finite_sheets.h"

#include "volumes/base/parallel.h"

namespace supple {

namespace {

constexpr Grain kTriangles{256};

NodeSets corners_of_membranes(const ShellTriangles& sheets) {
  NodeSets out;
  for (const ShellTriangles::Triangle& of : sheets.triangles()) {
    const bool stretches = sheets.sheets()[std::size_t(of.sheet)].kind != SheetKind::bending;
    if (stretches) out.add(of.corners.data(), 3);
  }
  return out;
}

void add_stiffness_of(const ShellTriangles& sheets, BlockCsr& matrix) {
  const std::size_t count = sheets.sheets().size();
  sheets.add_to(matrix, std::vector<double>(count, 1), std::vector<double>(count, 0));
}

}  // namespace

FiniteSheets::FiniteSheets(const ShellTriangles& sheets, const std::vector<Vec3d>& positions,
                           std::size_t node_count)
    : m_corners(corners_of_membranes(sheets)),
      m_of_node(positions.size(), m_corners),
      m_bent(sheets.bending_alone(positions)),
      m_bending(node_count, {&m_bent.sets()}) {
  add_stiffness_of(m_bent, m_bending);
  for (const ShellTriangles::Triangle& of : sheets.triangles()) {
    const ElasticSheet& sheet = sheets.sheets()[std::size_t(of.sheet)];
    if (sheet.kind == SheetKind::bending) continue;
    const auto corner = [&](std::size_t c) { return positions[std::size_t(of.corners[c])]; };
    const Vec3d twice = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    Membrane out;
    for (std::size_t c = 0; c < 3; ++c) {
      out.gradients[c] = twice.cross(corner((c + 2) % 3) - corner((c + 1) % 3)) / twice.dot(twice);
    }
    const double weight = sheet.young_kpa * sheet.thickness_mm * twice.length() / 2;
    out.lambda = weight * sheet.poisson / (1 - sheet.poisson * sheet.poisson);
    out.mu = weight / (2 * (1 + sheet.poisson));
    m_membranes.push_back(out);
  }
}

FiniteSheets::Stretched FiniteSheets::stretched(std::size_t membrane, const double* u_mm) const {
  const Membrane& of = m_membranes[membrane];
  const NodeIndex* corners = m_corners.nodes(membrane);
  // H = du/dx in the plane.
  const Vec3d normal = of.gradients[0].cross(of.gradients[1]).normalized();
  Matrix9 h{}, plane = kIdentity9;
  for (std::size_t m = 0; m < 9; ++m) {
    for (std::size_t c = 0; c < 3; ++c) {
      h[m] += u_mm[3 * std::size_t(corners[c]) + m / 3] * of.gradients[c][int(m % 3)];
    }
    plane[m] -= normal[int(m / 3)] * normal[int(m % 3)];
  }
  Stretched out;
  Matrix9 strain{};
  const auto at = [](std::size_t i, std::size_t j) { return 3 * i + j; };
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      out.f[at(i, j)] = plane[at(i, j)] + h[at(i, j)];
      double& e = strain[at(i, j)];
      for (std::size_t k = 0; k < 3; ++k) {
        e += (plane[at(k, i)] * h[at(k, j)] + h[at(k, i)] * plane[at(k, j)] +
              h[at(k, i)] * h[at(k, j)]) /
             2;
      }
    }
  }
  const double trace = strain[0] + strain[4] + strain[8];
  for (std::size_t m = 0; m < 9; ++m) {
    out.stress[m] = of.lambda * trace * plane[m] + 2 * of.mu * strain[m];
    out.energy_uj += out.stress[m] * strain[m] / 2;
  }
  return out;
}

std::vector<FiniteSheets::Stretched> FiniteSheets::all_stretched(const double* u_mm) const {
  std::vector<Stretched> out(m_membranes.size());
  parallel_for(out.size(), kTriangles, [&](std::size_t n) { out[n] = stretched(n, u_mm); });
  return out;
}

double FiniteSheets::add_forces(const double* u_mm, double* force_mn) const {
  std::vector<double> bending(3 * m_bending.node_count(), 0.0);
  m_bending.add(u_mm, bending.data());
  const std::vector<Stretched> membranes = all_stretched(u_mm);
  double energy_uj = 0;
  for (std::size_t n = 0; n < bending.size(); ++n) {
    force_mn[n] += bending[n];
    energy_uj += u_mm[n] * bending[n] / 2;
  }
  for (const Stretched& of : membranes) energy_uj += of.energy_uj;
  parallel_for(m_of_node.begin.size() - 1, kTriangles, [&](std::size_t node) {
    Vec3d force(0);
    for (std::int32_t n = m_of_node.begin[node]; n < m_of_node.begin[node + 1]; ++n) {
      const SetsOfNodes::Place place = m_of_node.places[std::size_t(n)];
      const Stretched& of = membranes[std::size_t(place.set)];
      const Vec3d& g = m_membranes[std::size_t(place.set)].gradients[std::size_t(place.at)];
      force += times(of.f, times(of.stress, g));
    }
    for (int a = 0; a < 3; ++a) force_mn[3 * node + std::size_t(a)] += force[a];
  });
  return energy_uj;
}

void FiniteSheets::add_tangent(const double* u_mm, BlockCsr& matrix) const {
  add_stiffness_of(m_bent, matrix);
  const std::vector<Stretched> membranes = all_stretched(u_mm);
  matrix.add_sets(m_corners, [&](std::size_t n, std::int32_t row, Matrix9* blocks) {
    const Membrane& of = m_membranes[n];
    const Stretched& at = membranes[n];
    const Matrix9 left = times_transposed(at.f, at.f);
    const Vec3d& g = of.gradients[std::size_t(row)];
    const Vec3d fg = times(at.f, g);
    for (std::size_t b = 0; b < 3; ++b) {
      const Vec3d& h = of.gradients[b];
      const Vec3d fh = times(at.f, h);
      const double along = of.mu * g.dot(h);
      for (std::size_t m = 0; m < 9; ++m) {
        const int i = int(m / 3), j = int(m % 3);
        blocks[b][m] = of.lambda * (fg[i] * fh[j]) + of.mu * (fh[i] * fg[j]) + along * left[m];
      }
      const double tension = g.dot(times(at.stress, h));
      for (std::size_t m = 0; m < 3; ++m) blocks[b][4 * m] += tension;
    }
  });
}

std::size_t FiniteSheets::bytes() const {
  return m_membranes.capacity() * sizeof(Membrane) + m_corners.bytes() + m_bent.bytes() +
         m_bending.bytes();
}

}  // namespace supple
