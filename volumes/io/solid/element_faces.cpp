#include "volumes/io/solid/element_faces.h"

#include <algorithm>
#include <unordered_set>

namespace supple {

namespace {

using Triangle = std::array<std::int32_t, 3>;

/// The same triangle from its smallest node on.
Triangle turned(const Triangle& t) {
  const std::size_t first = std::size_t(std::min_element(t.begin(), t.end()) - t.begin());
  return {t[first], t[(first + 1) % 3], t[(first + 2) % 3]};
}

struct TriangleHash {
  std::size_t operator()(const Triangle& t) const {
    std::uint64_t h = std::uint32_t(t[0]);
    for (const int n : {1, 2}) {
      h = (h ^ (h >> 29)) * 0x9E3779B97F4A7C15U + std::uint32_t(t[std::size_t(n)]);
    }
    return std::size_t(h ^ (h >> 32));
  }
};

}  // namespace

std::vector<Triangle> triangles_of(const SolidMesh& mesh, const ElementSide& side) {
  // Corners of sides go clockwise, seen from outside.
  const std::size_t tets = mesh.tets.size(), element = std::size_t(side.element);
  if (element < tets) {
    const int* c = kTetSides[side.side];
    const auto& tet = mesh.tets[element];
    return {{tet[std::size_t(c[0])], tet[std::size_t(c[2])], tet[std::size_t(c[1])]}};
  }
  const int* c = kHexSides[side.side];
  const auto& hex = mesh.hexes[element - tets];
  const std::int32_t a = hex[std::size_t(c[0])], b = hex[std::size_t(c[1])],
                     d = hex[std::size_t(c[2])], e = hex[std::size_t(c[3])];
  // Both ways to halve a square.
  return {{a, d, b}, {a, e, d}, {b, a, e}, {b, e, d}};
}

std::vector<ElementSide> sides_of(const SolidMesh& mesh, const FaceSet& faces) {
  std::unordered_set<Triangle, TriangleHash> wanted;
  std::vector<char> is_node(mesh.nodes_lps_mm.size(), 0);
  for (const Triangle& triangle : faces.triangles) {
    wanted.insert(turned(triangle));
    for (const std::int32_t node : triangle) is_node[std::size_t(node)] = 1;
  }
  std::vector<ElementSide> sides;
  for (std::size_t e = 0; e < mesh.element_count(); ++e) {
    const bool is_tet = e < mesh.tets.size();
    int on_faces = 0;
    const auto count = [&](const auto& corners) {
      for (const std::int32_t node : corners) on_faces += is_node[std::size_t(node)];
    };
    is_tet ? count(mesh.tets[e]) : count(mesh.hexes[e - mesh.tets.size()]);
    for (int s = 0; on_faces >= 3 && s < (is_tet ? 4 : 6); ++s) {
      const ElementSide side{std::int64_t(e), s};
      const std::vector<Triangle> triangles = triangles_of(mesh, side);
      const bool is_in = std::any_of(triangles.begin(), triangles.end(), [&](const Triangle& t) {
        return wanted.count(turned(t)) != 0;
      });
      if (is_in) sides.push_back(side);
    }
  }
  return sides;
}

}  // namespace supple
