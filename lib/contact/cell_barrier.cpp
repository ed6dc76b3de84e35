#include "lib/contact/cell_barrier.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

constexpr double kThreshold = 0.2;     // of J
constexpr double kParabolaFrom = 0.3;  // of s

double volume_of(const std::array<Vec3d, 3>& edges) {
  return edges[0].dot(edges[1].cross(edges[2]));
}

}  // namespace

double inversion_barrier(double s) {
  if (s >= 1) return 0;
  if (s >= kParabolaFrom) return -(1 - s) * (1 - s) * std::log(s);
  const double below = s - kParabolaFrom;
  return inversion_barrier(kParabolaFrom) + below * inversion_barrier_first(kParabolaFrom) +
         0.5 * below * below * inversion_barrier_second(kParabolaFrom);
}

// b' = 2 (1 - s) ln s - (1 - s)^2 / s
double inversion_barrier_first(double s) {
  if (s >= 1) return 0;
  if (s >= kParabolaFrom) return 2 * (1 - s) * std::log(s) - (1 - s) * (1 - s) / s;
  return inversion_barrier_first(kParabolaFrom) +
         (s - kParabolaFrom) * inversion_barrier_second(kParabolaFrom);
}

// b'' = -2 ln s + 4 (1 - s) / s + (1 - s)^2 / s^2
double inversion_barrier_second(double s) {
  if (s >= 1) return 0;
  if (s < kParabolaFrom) s = kParabolaFrom;
  const double ratio = (1 - s) / s;
  return -2 * std::log(s) + 4 * ratio + ratio * ratio;
}

CellBarrier::CellBarrier(const std::array<Vec3d, 3>& axes_mm, int flat_axis,
                         std::vector<Node> nodes)
    : m_axes_mm(axes_mm),
      m_inverse_volume_mm3(1 / volume_of(axes_mm)),
      m_flat_axis(flat_axis),
      m_nodes(std::move(nodes)) {}

/// Finds a cell's corners; bit a of an index: far end of axis a. A flat axis has but one node.
bool CellBarrier::cell_at(int node, std::array<int, 8>& corners) const {
  corners[0] = node;
  for (int axis = 0, count = 1; axis < 3; ++axis, count *= 2) {
    for (int n = 0; n < count; ++n) {
      const int next = axis == m_flat_axis ? corners[n] : m_nodes[corners[n]].next[axis];
      if (next < 0) return false;
      corners[n + count] = next;
    }
  }
  // Every way round leads to the same nodes, as no link of the cell is cut.
  for (int n = 0; n < 8; ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      if ((n >> axis & 1) != 0 || axis == m_flat_axis) continue;
      if (m_nodes[corners[n]].next[axis] != corners[n | 1 << axis]) return false;
    }
  }
  return true;
}

CellBarrier::Corner CellBarrier::corner_of(const std::array<int, 8>& cell, int corner) const {
  Corner found;
  found.node[0] = cell[corner];
  double side = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == m_flat_axis) {
      found.node[axis + 1] = -1;
      continue;
    }
    found.node[axis + 1] = cell[corner ^ 1 << axis];
    if ((corner >> axis & 1) != 0) side = -side;
  }
  const double h2 = std::pow(std::abs(m_inverse_volume_mm3), -2.0 / 3);
  found.inverse_volume_mm3 = side * m_inverse_volume_mm3;
  found.weight_uj = m_nodes[cell[corner]].stiffness_n_m * h2 / (m_flat_axis < 0 ? 8 : 4);
  return found;
}

Vec3d CellBarrier::edge(const Corner& corner, int axis, const std::vector<Vec3d>& pos_mm) const {
  const int end = corner.node[axis + 1];
  return end < 0 ? m_axes_mm[axis] : pos_mm[end] - pos_mm[corner.node[0]];
}

/// J at a corner of a cell: edges all point along their axes here, which is the same.
double CellBarrier::ratio(const std::array<int, 8>& cell, int corner,
                          const std::vector<Vec3d>& pos_mm) const {
  std::array<Vec3d, 3> edges = m_axes_mm;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == m_flat_axis) continue;
    edges[axis] = pos_mm[cell[corner | 1 << axis]] - pos_mm[cell[corner & ~(1 << axis)]];
  }
  return volume_of(edges) * m_inverse_volume_mm3;
}

/// Marks nodes with an edge to the next one that is far from its rest. Cells without such edges are
/// well above the threshold: with D = change of the edges times the inverse of the axes, |D| <= 0.4
/// and J = det(1 + D) >= (1 - |D|)^3. Empty: there is none.
std::vector<char> CellBarrier::rough_nodes(const std::vector<Vec3d>& pos_mm) const {
  constexpr double kLargest = 0.4;
  double inverse2 = 0;  // squared norm of the inverse of the axes
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3d& b = m_axes_mm[(axis + 1) % 3];
    inverse2 += (b.cross(m_axes_mm[(axis + 2) % 3]) * m_inverse_volume_mm3).length2();
  }
  const double most2 = kLargest * kLargest / (3 * inverse2);
  std::vector<char> rough;
  for (std::size_t n = 0; n < m_nodes.size(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      const int next = m_nodes[n].next[axis];
      if (next < 0 || (pos_mm[next] - pos_mm[n] - m_axes_mm[axis]).length2() <= most2) continue;
      rough.resize(m_nodes.size(), 0);
      rough[n] = 1;
    }
  }
  return rough;
}

void CellBarrier::wake(const std::vector<Vec3d>& pos_mm) {
  const std::vector<char> rough = rough_nodes(pos_mm);
  if (rough.empty()) return;
  std::array<int, 8> cell;
  for (std::size_t n = 0; n < m_nodes.size(); ++n) {
    if (!cell_at(int(n), cell)) continue;
    if (std::none_of(cell.begin(), cell.end(), [&](int node) { return rough[node] != 0; })) {
      continue;
    }
    for (int c = 0; c < 8; ++c) {
      if (m_flat_axis >= 0 && (c >> m_flat_axis & 1) != 0) continue;
      if (ratio(cell, c, pos_mm) >= kThreshold) continue;
      m_is_awake.resize(m_nodes.size(), 0);
      if ((m_is_awake[n] >> c & 1) != 0) continue;
      m_is_awake[n] |= std::uint8_t(1 << c);
      m_awake.push_back(corner_of(cell, c));
    }
  }
}

CellBarrier::Response CellBarrier::response(const Corner& corner,
                                            const std::vector<Vec3d>& pos_mm) const {
  const Vec3d e[3] = {edge(corner, 0, pos_mm), edge(corner, 1, pos_mm), edge(corner, 2, pos_mm)};
  const double factor = corner.inverse_volume_mm3 / kThreshold;
  Response found;
  found.per_edge_1_mm = {e[1].cross(e[2]) * factor, e[2].cross(e[0]) * factor,
                         e[0].cross(e[1]) * factor};
  const double s = found.s = e[0].dot(found.per_edge_1_mm[0]);
  found.energy_uj = corner.weight_uj * inversion_barrier(s);
  found.first_uj = corner.weight_uj * inversion_barrier_first(s);
  found.second_uj = corner.weight_uj * inversion_barrier_second(s);
  return found;
}

double CellBarrier::energy_uj(const std::vector<Vec3d>& pos_mm) const {
  double sum = 0;
  for (const Corner& corner : m_awake) sum += response(corner, pos_mm).energy_uj;
  return sum;
}

void CellBarrier::add_forces(const std::vector<Vec3d>& pos_mm, std::vector<Vec3d>& force_mn) const {
  for (const Corner& corner : m_awake) {
    const Response found = response(corner, pos_mm);
    if (found.first_uj == 0) continue;
    for_each_node(corner, found, [&](int node, const Vec3d& per_mm) {
      force_mn[node] -= per_mm * found.first_uj;
    });
  }
}

// Sums of the norms of 3 x 3 blocks along a row bound an eigenvalue (Gershgorin).
double CellBarrier::stiffness_1_s2(const std::vector<Vec3d>& pos_mm,
                                   const std::vector<double>& mass_kg) const {
  constexpr double kMotion = 0.2;
  std::vector<double> row_sum(mass_kg.size(), 0);
  double largest = 0;
  for (const Corner& corner : m_awake) {
    const Response found = response(corner, pos_mm);
    double all = 0;
    for_each_node(corner, found, [&](int, const Vec3d& per_mm) { all += per_mm.length(); });
    const double second = corner.weight_uj * inversion_barrier_second(found.s - kMotion);
    for_each_node(corner, found, [&](int node, const Vec3d& per_mm) {
      row_sum[node] += second * per_mm.length() * all / mass_kg[node];
      largest = std::max(largest, row_sum[node]);
    });
  }
  return largest;
}

std::size_t CellBarrier::bytes() const {
  return m_nodes.capacity() * sizeof(Node) + m_awake.capacity() * sizeof(Corner) +
         m_is_awake.capacity();
}

}  // namespace supple
