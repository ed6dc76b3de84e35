// Edges of triangles and tetrahedra, each once, and the pairs of triangles that share one.
// Cost: a sort of the edges; 24 bytes per triangle corner meanwhile.
#pragma once

#include <vector>

#include "lib/mesh/mesh_body.h"

namespace supple {

/// Every edge once, lower index first, ascending.
std::vector<LinkNodes> unique_edges(const std::vector<TriangleNodes>& triangles);
std::vector<LinkNodes> unique_edges(const std::vector<TetrahedronNodes>& tetrahedra);
/// The links sorted, lower index first, doubles removed.
std::vector<LinkNodes> unique_links(std::vector<LinkNodes> links);

/// Two triangles that share an edge, by the vertices opposite of it.
struct Hinge {
  LinkNodes edge;
  LinkNodes opposite;
};
/// Edges of two triangles give one hinge, those of the rim none, and where n triangles meet every
/// two of them one. Ascending by edge.
std::vector<Hinge> find_hinges(const std::vector<TriangleNodes>& triangles);

}  // namespace supple
