#include "lib/session/tets/parted_labels.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "lib/mesh/tets/solid_faces.h"

namespace supple {

namespace {

using FaceNodes = std::array<std::int32_t, 3>;
constexpr std::size_t kFacesOfTet[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

FaceNodes sorted(FaceNodes nodes) {
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

/// The root of a set of joined elements.
std::size_t root_of(std::vector<std::size_t>& parent, std::size_t n) {
  while (parent[n] != n) n = parent[n] = parent[parent[n]];
  return n;
}

}  // namespace

std::set<std::pair<std::int32_t, std::int32_t>> parted_labels(const Body& body,
                                                              const BrickValues& labels) {
  std::set<std::pair<std::int32_t, std::int32_t>> parted;
  const LinkCuts none;
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    if (body.cuts.brick(b) == nullptr) continue;
    for_each_link(body.elements, none, b, [&](int axis, Slot low, Slot high) {
      if (!body.cuts.is_cut(b, int(low % kBrickVoxels), axis)) return;
      const std::int32_t first = labels.at(low), second = labels.at(high);
      if (first != second) {
        parted.insert(std::minmax(first, second));
        return;
      }
      throw InputError({"", "cut", "a cut within label " + std::to_string(first) + " beside tets",
                        "cuts between labels, or model = \"fem\""});
    });
  }
  return parted;
}

void part_mesh(const std::set<std::string>& borders,
               const std::map<std::int32_t, std::string>& names, SolidMesh& mesh) {
  std::set<FaceNodes> banks;
  std::map<std::int32_t, std::vector<std::size_t>> around;  // elements at nodes of borders
  for (const FaceSet& set : mesh.faces) {
    if (borders.count(set.name) == 0) continue;
    for (const FaceNodes& face : set.triangles) {
      banks.insert(sorted(face));
      for (const std::int32_t node : face) around[node];
    }
  }
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (const std::int32_t node : mesh.tets[t]) {
      const auto found = around.find(node);
      if (found != around.end()) found->second.push_back(t);
    }
  }
  const std::vector<std::array<std::int32_t, 4>> whole = mesh.tets;
  std::vector<std::int32_t> origin(mesh.nodes_lps_mm.size());
  std::iota(origin.begin(), origin.end(), 0);
  for (const auto& [node, tets] : around) {
    std::vector<std::size_t> parent(tets.size());
    std::iota(parent.begin(), parent.end(), std::size_t(0));
    std::map<FaceNodes, std::size_t> seen;
    for (std::size_t n = 0; n < tets.size(); ++n) {
      for (std::size_t f = 0; f < 4; ++f) {
        FaceNodes nodes{};
        for (std::size_t c = 0; c < 3; ++c) nodes[c] = whole[tets[n]][kFacesOfTet[f][c]];
        nodes = sorted(nodes);
        if (std::count(nodes.begin(), nodes.end(), node) == 0 || banks.count(nodes) > 0) continue;
        const auto [other, is_new] = seen.try_emplace(nodes, n);
        if (!is_new) parent[root_of(parent, n)] = root_of(parent, other->second);
      }
    }
    std::map<std::size_t, std::int32_t> copy_of{{root_of(parent, 0), node}};
    for (std::size_t n = 0; n < tets.size(); ++n) {
      const auto [copy, is_new] =
          copy_of.try_emplace(root_of(parent, n), std::int32_t(mesh.nodes_lps_mm.size()));
      if (is_new) {
        mesh.nodes_lps_mm.push_back(mesh.nodes_lps_mm[std::size_t(node)]);
        origin.push_back(node);
      }
      std::replace(mesh.tets[tets[n]].begin(), mesh.tets[tets[n]].end(), node, copy->second);
    }
  }
  mesh.faces = faces_of_regions(mesh, names);
  const auto is_bank = [&](const std::array<std::int32_t, 3>& face) {
    FaceNodes nodes{};
    for (std::size_t c = 0; c < 3; ++c) nodes[c] = origin[std::size_t(face[c])];
    return banks.count(sorted(nodes)) > 0;
  };
  for (FaceSet& set : mesh.faces) {
    set.triangles.erase(std::remove_if(set.triangles.begin(), set.triangles.end(), is_bank),
                        set.triangles.end());
  }
}

}  // namespace supple
