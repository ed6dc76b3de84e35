#include "lib/mesh/mesh_edges.h"

#include <algorithm>

namespace supple {

namespace {

LinkNodes ordered(int a, int b) {
  return a < b ? LinkNodes{a, b} : LinkNodes{b, a};
}

template <std::size_t count>
std::vector<LinkNodes> edges_of(const std::vector<std::array<int, count>>& cells) {
  std::vector<LinkNodes> edges;
  edges.reserve(cells.size() * count * (count - 1) / 2);
  for (const auto& cell : cells) {
    for (std::size_t a = 0; a < count; ++a) {
      for (std::size_t b = a + 1; b < count; ++b) edges.push_back(ordered(cell[a], cell[b]));
    }
  }
  return unique_links(std::move(edges));
}

}  // namespace

std::vector<LinkNodes> unique_links(std::vector<LinkNodes> links) {
  for (LinkNodes& link : links) link = ordered(link[0], link[1]);
  std::sort(links.begin(), links.end());
  links.erase(std::unique(links.begin(), links.end()), links.end());
  return links;
}

std::vector<LinkNodes> unique_edges(const std::vector<TriangleNodes>& triangles) {
  return edges_of(triangles);
}

std::vector<LinkNodes> unique_edges(const std::vector<TetrahedronNodes>& tetrahedra) {
  return edges_of(tetrahedra);
}

std::vector<Hinge> find_hinges(const std::vector<TriangleNodes>& triangles) {
  // Every side of every triangle with the corner opposite of it, sorted so that the sides of one
  // edge lie together.
  struct Side {
    LinkNodes edge;
    int opposite;
    bool operator<(const Side& other) const {
      return edge != other.edge ? edge < other.edge : opposite < other.opposite;
    }
  };
  std::vector<Side> sides;
  sides.reserve(triangles.size() * 3);
  for (const TriangleNodes& t : triangles) {
    for (int c = 0; c < 3; ++c) {
      sides.push_back({ordered(t[(c + 1) % 3], t[(c + 2) % 3]), t[c]});
    }
  }
  std::sort(sides.begin(), sides.end());
  std::vector<Hinge> hinges;
  for (std::size_t first = 0; first < sides.size(); ++first) {
    for (std::size_t n = first + 1; n < sides.size() && sides[n].edge == sides[first].edge; ++n) {
      if (sides[n].opposite == sides[first].opposite) continue;  // the same triangle twice
      hinges.push_back({sides[first].edge, {sides[first].opposite, sides[n].opposite}});
    }
  }
  return hinges;
}

}  // namespace supple
