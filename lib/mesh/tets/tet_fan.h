// Tetrahedra between the points at which one tetrahedron is cut: on its edges, in its faces and
// within. One rule makes all stencils, of isosurface stuffing and of lattice cleaving.
//
// A tetrahedron has 24 flags of a corner, an edge from there, a face beside it and itself; each is
// a tetrahedron of the corner, the cut of the edge, the point of the face and the tip. A point that
// is not there falls together with another: the cut of an edge that is not cut with an end of it,
// the point of a face with its cut of the highest rank, the tip with that of all. Flags of fewer
// than four points vanish. So faces are divided alike on both sides, and no volume is negative.
// Sources: J. R. Bronson et al., Lattice cleaving, 2013 (24 tetrahedra that collapse); F. Labelle,
// J. R. Shewchuk, Isosurface stuffing, 2007 (the diagonal of a face ends at the cut of its long
// edge, else as parity has it, which is here that of the short edge).
#pragma once

#include <array>
#include <cstdint>

#include "lib/mesh/tets/bcc_lattice.h"
#include "lib/mesh/tets/tet_shape.h"

namespace supple {

/// The points of a tetrahedron by number; -1: not there.
struct TetPoints {
  std::array<std::int32_t, 4> corners{};
  std::array<std::int32_t, 6> cuts{-1, -1, -1, -1, -1, -1};
  std::array<std::int32_t, 4> in_face{-1, -1, -1, -1};  // of the face that lacks this corner
  std::array<std::uint64_t, 6> ranks{};                 // of edges, all different in a face

  /// The cut of the highest rank, of edges without a corner, or of all (-1); -1: none.
  std::int32_t first_cut(int without) const {
    std::int32_t cut = -1;
    std::uint64_t highest = 0;
    for (std::size_t e = 0; e < 6; ++e) {
      if (cuts[e] < 0 || kTetEdges[e][0] == without || kTetEdges[e][1] == without) continue;
      if (cut >= 0 && ranks[e] <= highest) continue;
      cut = cuts[e];
      highest = ranks[e];
    }
    return cut;
  }
};

/// The rank of an edge of the lattice between two places: the longer first, then short edges by
/// parity. Differs among the edges of a face of the uniform lattice.
inline std::uint64_t edge_rank(LatticePlace p, LatticePlace q) {
  Vec3i step = q - p;
  const auto length2 = std::uint64_t(std::int64_t(step.x) * step.x + std::int64_t(step.y) * step.y +
                                     std::int64_t(step.z) * step.z);
  const int unit = std::abs(step.x);
  if (unit == 0 || std::abs(step.y) != unit || std::abs(step.z) != unit) return 2 * length2;
  if ((p.x / unit & 1) == 0) step = -step;  // from the centre on
  return 2 * length2 + unsigned(((step.x > 0) + (step.y > 0) + (step.z > 0)) & 1);
}

/// Calls emit(a, b, c, d) for tetrahedra of positive volume, where that of the corners is. With a
/// point in a face, `tip` is one of these or within; else the cut of the highest rank.
template <class Emit>
void fan(const TetPoints& points, std::int32_t tip, const Emit& emit) {
  std::array<std::int32_t, 4> of_face = points.in_face;
  for (int f = 0; f < 4; ++f) {
    std::int32_t& point = of_face[std::size_t(f)];
    if (point < 0) point = points.first_cut(f);
    if (point < 0) point = points.corners[f == 0 ? 1 : 0];
  }
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < 4; ++b) {
      if (b == a) continue;
      const std::int32_t corner = points.corners[std::size_t(a)];
      std::int32_t cut = points.cuts[std::size_t(kEdgeBetween[a][b])];
      if (cut < 0) cut = points.corners[std::size_t(std::min(a, b))];
      if (cut == corner || corner == tip || cut == tip) continue;
      for (int c = 0; c < 4; ++c) {
        if (c == a || c == b) continue;
        const int d = 6 - a - b - c;
        const std::int32_t in_face = of_face[std::size_t(d)];
        if (in_face == corner || in_face == cut || in_face == tip) continue;
        const int swaps = (a > b) + (a > c) + (a > d) + (b > c) + (b > d) + (c > d);
        (swaps & 1) == 0 ? emit(corner, cut, in_face, tip) : emit(cut, corner, in_face, tip);
      }
    }
  }
}

}  // namespace supple
