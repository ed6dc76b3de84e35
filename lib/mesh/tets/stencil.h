// The part of one lattice tetrahedron that lies inside a surface, as tetrahedra: the stencils of
// isosurface stuffing.
// Source: F. Labelle, J. R. Shewchuk, Isosurface stuffing: fast tetrahedral meshes with good
// dihedral angles, ACM Trans. Graphics 26 (3), 57, 2007, section 3.2. Where a face of the lattice
// is cut to a quadrilateral, its diagonal follows from the face alone, so that neighbours agree: it
// ends at the cut of the long edge, else at the vertex that parity chooses.
#pragma once

#include <array>
#include <cstdint>

#include "lib/mesh/tets/bcc_lattice.h"

namespace supple {

/// A tetrahedron of the lattice of positive volume whose long edges are 0-1 and 2-3.
struct LatticeTet {
  std::array<LatticePlace, 4> places;
  std::array<std::int8_t, 4> signs;   // -1 inside, 0 on the surface, 1 outside
  std::array<std::int32_t, 4> nodes;  // of vertices that are not outside
};

/// Calls emit(a, b, c, d) for tetrahedra of positive volume; cut(p, q) is the node between corner
/// p, which is inside, and q, which is outside.
template <class Cut, class Emit>
void stuff(const LatticeTet& tet, const Cut& cut, const Emit& emit);

namespace stencil {

/// True if the diagonal of the quadrilateral u1, u2, cut(u2, v), cut(u1, v) ends at u1.
inline bool is_diagonal_at_first(const LatticeTet& tet, int u1, int u2, int v) {
  if ((v ^ 1) == u1) return false;
  if ((v ^ 1) == u2) return true;
  const auto& from = tet.places[std::size_t(v)];
  const auto& to = tet.places[std::size_t(u1)];
  return (((to.x > from.x) + (to.y > from.y) + (to.z > from.z)) & 1) == 0;
}

/// The pyramid over the quadrilateral between the edges u1-v and u2-v, with its tip at `tip`; the
/// volume of u1, u2, tip, v is positive.
template <class Cut, class Emit>
void pyramid(const LatticeTet& tet, int u1, int u2, std::int32_t tip, int v, const Cut& cut,
             const Emit& emit) {
  const std::int32_t n1 = tet.nodes[std::size_t(u1)], n2 = tet.nodes[std::size_t(u2)];
  const std::int32_t c1 = cut(u1, v), c2 = cut(u2, v);
  if (is_diagonal_at_first(tet, u1, u2, v)) {
    emit(n1, n2, tip, c2);
    emit(n1, c2, tip, c1);
  } else {
    emit(n1, n2, tip, c1);
    emit(c1, n2, tip, c2);
  }
}

/// Three inside, v outside.
template <class Cut, class Emit>
void truncated(const LatticeTet& tet, int v, const Cut& cut, const Emit& emit) {
  const int w = v ^ 1;  // at the other end of the long edge
  int p = v < 2 ? 2 : 0, q = p + 1;
  // Positive are (0, 1, 2, 3) and (2, 3, 0, 1): w, p, q, v is, or w, q, p, v.
  if (w > v) std::swap(p, q);
  const std::int32_t tip = cut(w, v);
  emit(tet.nodes[std::size_t(w)], tet.nodes[std::size_t(p)], tet.nodes[std::size_t(q)], tip);
  pyramid(tet, p, q, tip, v, cut, emit);
}

/// Two inside, u1 and u2, two outside, v1 and v2: a wedge. `is_positive`: the volume of the four
/// is.
template <class Cut, class Emit>
void wedge(const LatticeTet& tet, int u1, int u2, int v1, int v2, bool is_positive, const Cut& cut,
           const Emit& emit) {
  const auto emit_turned = [&](std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
    is_positive ? emit(a, b, c, d) : emit(b, a, c, d);
  };
  // The diagonal of the face at v1 ends at u1 in the first case, at u2 in the second, and that of
  // the face at v2 at the other one: long edges and parity both see to that. The third follows.
  const bool is_long = (u1 ^ 1) == u2;
  if (is_long ? !is_diagonal_at_first(tet, u1, u2, v1) : (u1 ^ 1) != v1) {
    std::swap(v1, v2);
    is_positive = !is_positive;
  }
  const std::int32_t n1 = tet.nodes[std::size_t(u1)], n2 = tet.nodes[std::size_t(u2)];
  const std::int32_t c11 = cut(u1, v1), c12 = cut(u1, v2), c21 = cut(u2, v1), c22 = cut(u2, v2);
  if (is_long) {
    emit_turned(n1, n2, c21, c12);
    emit_turned(n1, c21, c11, c12);
    emit_turned(c12, n2, c21, c22);
  } else {
    emit_turned(n1, n2, c11, c22);
    emit_turned(c11, n2, c21, c22);
    emit_turned(n1, c22, c11, c12);
  }
}

/// True for even permutations of 0, 1, 2, 3.
inline bool is_even(int a, int b, int c, int d) {
  const int swaps = (a > b) + (a > c) + (a > d) + (b > c) + (b > d) + (c > d);
  return (swaps & 1) == 0;
}

}  // namespace stencil

template <class Cut, class Emit>
void stuff(const LatticeTet& tet, const Cut& cut, const Emit& emit) {
  std::array<int, 4> inside{}, on{}, outside{};
  int in = 0, zero = 0, out = 0;
  for (int n = 0; n < 4; ++n) {
    const std::int8_t sign = tet.signs[std::size_t(n)];
    if (sign < 0) inside[std::size_t(in++)] = n;
    if (sign == 0) on[std::size_t(zero++)] = n;
    if (sign > 0) outside[std::size_t(out++)] = n;
  }
  if (in == 0) return;
  if (out == 0) return emit(tet.nodes[0], tet.nodes[1], tet.nodes[2], tet.nodes[3]);
  if (in == 1) {
    std::array<std::int32_t, 4> nodes = tet.nodes;
    for (int n = 0; n < out; ++n) {
      nodes[std::size_t(outside[std::size_t(n)])] = cut(inside[0], outside[std::size_t(n)]);
    }
    return emit(nodes[0], nodes[1], nodes[2], nodes[3]);
  }
  if (in == 3) return stencil::truncated(tet, outside[0], cut, emit);
  if (out == 2) {
    const bool is_positive = stencil::is_even(inside[0], inside[1], outside[0], outside[1]);
    return stencil::wedge(tet, inside[0], inside[1], outside[0], outside[1], is_positive, cut,
                          emit);
  }
  if (!stencil::is_even(inside[0], inside[1], on[0], outside[0])) std::swap(inside[0], inside[1]);
  stencil::pyramid(tet, inside[0], inside[1], tet.nodes[std::size_t(on[0])], outside[0], cut, emit);
}

}  // namespace supple
