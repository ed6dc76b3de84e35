// A barrier against cells that turn inside out. Springs alone let the corner of a cell pass through
// the opposite side, since their energy has a minimum there, too.
//
// At each corner of a cell between eight nodes, with edges e_i to the corner's neighbours and
// J = det(e_1, e_2, e_3) over its value at rest, stands the energy
//   W b(s),  b(s) = -(1 - s)^2 ln s,  s = J / 0.2,  for s < 1, and 0 for s >= 1,
// after M. Li et al. (Incremental potential contact, 2020, eq. 6), which has two continuous
// derivatives at s = 1. Below s = 0.3 the parabola that b meets there goes on, so that bodies that
// begin inside out find back. W = k h^2 / 8: k the stiffness of springs along the edges, h^3 the
// cell's volume. Where the volume has one slice, cells are squares, the missing edge is the
// slice's axis at rest and W = k h^2 / 4: they keep their area as seen along that axis. A cell
// whose corners are all the right way round may still fold a little inside; squares cannot.
//
// Corners sleep until J is first below 0.2: until then the barrier changes nothing, and costs 16
// bytes and, per look, 5 ns per node (25 where an edge anywhere is far from its rest, 0.2 us where
// all are). An awake corner takes 32 bytes and 0.1 us per evaluation.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

/// b(s) and its derivatives; defined for every s.
double inversion_barrier(double s);
double inversion_barrier_first(double s);
double inversion_barrier_second(double s);

class CellBarrier {
 public:
  /// Place of a node in the lattice.
  struct Node {
    std::array<int, 3> next;  // at the end of the link along each axis; -1: none
    float stiffness_n_m;      // k; a corner has that of its node
  };
  /// A corner that has been below the threshold; node[0] and its neighbours, -1 along the axis of a
  /// single slice.
  struct Corner {
    std::array<int, 4> node;
    double inverse_volume_mm3;  // signed: times det(e_1, e_2, e_3) it is J
    double weight_uj;           // W
  };
  /// Energy of a corner at the present positions, and its derivatives by s.
  struct Response {
    double s = 0;
    double energy_uj = 0, first_uj = 0, second_uj = 0;  // W b(s) and its derivatives
    std::array<Vec3d, 3> per_edge_1_mm;                 // ds / de_i
  };

  /// No barrier.
  CellBarrier() = default;
  /// `axes_mm`: edges of a cell at rest; `flat_axis`: that of a volume of a single slice, or -1.
  CellBarrier(const std::array<Vec3d, 3>& axes_mm, int flat_axis, std::vector<Node> nodes);

  /// Wakes the corners that are below the threshold.
  void wake(const std::vector<Vec3d>& pos_mm);
  const std::vector<Corner>& awake() const { return m_awake; }
  Response response(const Corner& corner, const std::vector<Vec3d>& pos_mm) const;

  double energy_uj(const std::vector<Vec3d>& pos_mm) const;
  /// Adds -grad of the energy, in mN.
  void add_forces(const std::vector<Vec3d>& pos_mm, std::vector<Vec3d>& force_mn) const;

  /// Upper bound of the largest eigenvalue of M^-1 times its matrix W b''(s) grad s grad s^T, with
  /// b'' of an s that is lower by a fifth, as motion may make it.
  double stiffness_1_s2(const std::vector<Vec3d>& pos_mm, const std::vector<double>& mass_kg) const;

  std::size_t bytes() const;

 private:
  bool cell_at(int node, std::array<int, 8>& corners) const;
  Corner corner_of(const std::array<int, 8>& cell, int corner) const;
  std::vector<char> rough_nodes(const std::vector<Vec3d>& pos_mm) const;
  double ratio(const std::array<int, 8>& cell, int corner, const std::vector<Vec3d>& pos_mm) const;
  Vec3d edge(const Corner& corner, int axis, const std::vector<Vec3d>& pos_mm) const;

  std::array<Vec3d, 3> m_axes_mm{};
  double m_inverse_volume_mm3 = 0;
  int m_flat_axis = -1;
  std::vector<Node> m_nodes;
  std::vector<std::uint8_t> m_is_awake;  // bit per corner of the cell at a node; empty: none
  std::vector<Corner> m_awake;
};

/// Calls with node and ds / d its position for each node of a corner.
template <class F>
void for_each_node(const CellBarrier::Corner& corner, const CellBarrier::Response& response,
                   const F& f) {
  Vec3d at_corner(0.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (corner.node[axis + 1] < 0) continue;
    f(corner.node[axis + 1], response.per_edge_1_mm[axis]);
    at_corner -= response.per_edge_1_mm[axis];
  }
  f(corner.node[0], at_corner);
}

}  // namespace supple
