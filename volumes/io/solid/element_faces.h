// Faces of a set as sides of elements, which decks of finite element programs name them by.
#pragma once

#include "volumes/io/solid/solid_mesh.h"

namespace supple {

/// A side by its number, from 0, in the order of CalculiX and Abaqus.
struct ElementSide {
  std::int64_t element;
  int side;
};

/// Corners of sides, in that order.
inline constexpr int kTetSides[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
inline constexpr int kHexSides[6][4] = {{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1},
                                        {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};

/// The sides of elements that triangles of a set belong to, ascending, each once: of both elements
/// where two share it, that from whose outside the triangle is seen. A square's two triangles are
/// one side. Triangles of no element are left out.
std::vector<ElementSide> sides_of(const SolidMesh& mesh, const FaceSet& faces);

/// The triangle of a tetrahedron's side, seen from outside of it; of a hexahedron's two and two,
/// for both ways to halve a square.
std::vector<std::array<std::int32_t, 3>> triangles_of(const SolidMesh& mesh,
                                                      const ElementSide& side);

}  // namespace supple
