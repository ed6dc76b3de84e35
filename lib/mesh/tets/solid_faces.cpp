#include "lib/mesh/tets/solid_faces.h"

#include <algorithm>
#include <numeric>
#include <set>

#include "volumes/base/parallel.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/solid/solid_formats.h"

namespace supple {

namespace {

/// Corners of faces as seen from outside; those of tetrahedra have no fourth.
constexpr int kTetFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
constexpr int kHexFaces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                 {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

struct ElementFace {
  std::array<std::int32_t, 4> key;   // nodes ascending; -1 in front of those of triangles
  std::array<std::int32_t, 4> seen;  // from outside of its element; -1 at the end of a triangle
  std::int32_t element;

  bool operator<(const ElementFace& other) const {
    return key != other.key ? key < other.key : element < other.element;
  }
};

ElementFace face_of(std::array<std::int32_t, 4> seen, std::size_t element) {
  ElementFace face{seen, seen, std::int32_t(element)};
  std::sort(face.key.begin(), face.key.end());
  return face;
}

/// All faces of all elements, those of the same nodes side by side.
std::vector<ElementFace> sorted_faces(const SolidMesh& mesh) {
  const std::size_t tets = mesh.tets.size();
  std::vector<ElementFace> faces(4 * tets + 6 * mesh.hexes.size());
  parallel_for(mesh.element_count(), Grain{4096}, [&](std::size_t e) {
    if (e < tets) {
      for (std::size_t f = 0; f < 4; ++f) {
        std::array<std::int32_t, 4> seen{0, 0, 0, -1};
        for (std::size_t c = 0; c < 3; ++c) seen[c] = mesh.tets[e][std::size_t(kTetFaces[f][c])];
        faces[4 * e + f] = face_of(seen, e);
      }
      return;
    }
    for (std::size_t f = 0; f < 6; ++f) {
      std::array<std::int32_t, 4> seen{};
      for (std::size_t c = 0; c < 4; ++c) {
        seen[c] = mesh.hexes[e - tets][std::size_t(kHexFaces[f][c])];
      }
      faces[4 * tets + 6 * (e - tets) + f] = face_of(seen, e);
    }
  });
  parallel_sort(faces.begin(), faces.end(), std::less<>());
  return faces;
}

/// Calls visit(face, other) for every face once; `other` is null where one element has it.
template <class Visit>
void for_each_face(const std::vector<ElementFace>& faces, const Visit& visit) {
  for (std::size_t n = 0; n < faces.size();) {
    const bool is_shared = n + 1 < faces.size() && faces[n + 1].key == faces[n].key;
    visit(faces[n], is_shared ? &faces[n + 1] : nullptr);
    n += is_shared ? 2 : 1;
  }
}

using RegionNames = std::map<std::int32_t, std::string>;

/// A name for each of the regions, ascending, which differ as words of a file, too.
RegionNames unique_names(const std::set<std::int32_t>& regions, const RegionNames& names) {
  RegionNames unique;
  std::set<std::string> words;
  for (const std::int32_t region : regions) {
    const auto given = names.find(region);
    std::string name = given != names.end() ? given->second : region_name(region);
    while (!words.insert(lower_case(word_of(name))).second) name += "_" + std::to_string(region);
    unique[region] = name;
  }
  return unique;
}

}  // namespace

RegionBorders borders_of_regions(const SolidMesh& mesh) {
  const auto region_of = [&](const ElementFace& face) {
    return mesh.region_of.empty() ? 1 : mesh.region_of[std::size_t(face.element)];
  };
  RegionBorders sets;
  for_each_face(sorted_faces(mesh), [&](const ElementFace& face, const ElementFace* other) {
    const std::int32_t region = region_of(face), beyond = other == nullptr ? 0 : region_of(*other);
    if (region == beyond) return;
    const bool is_first = beyond == 0 || region < beyond;
    const auto& seen = is_first ? face.seen : other->seen;
    FaceSet& set = sets[is_first ? std::pair(region, beyond) : std::pair(beyond, region)];
    set.triangles.push_back({seen[0], seen[1], seen[2]});
    if (seen[3] >= 0) set.triangles.push_back({seen[0], seen[2], seen[3]});
  });
  return sets;
}

std::vector<FaceSet> faces_of_regions(const SolidMesh& mesh,
                                      const std::map<std::int32_t, std::string>& names) {
  RegionBorders sets = borders_of_regions(mesh);
  std::set<std::int32_t> regions_of_sets;
  for (const auto& [regions, set] : sets) {
    regions_of_sets.insert(regions.first);
    if (regions.second != 0) regions_of_sets.insert(regions.second);
  }
  const RegionNames unique = unique_names(regions_of_sets, names);
  std::vector<FaceSet> faces;
  for (auto& [regions, set] : sets) {
    set.name = unique.at(regions.first);
    if (regions.second != 0) set.name += " to " + unique.at(regions.second);
    faces.push_back(std::move(set));
  }
  return faces;
}

SurfaceTopology topology_of(const std::vector<std::array<std::int32_t, 3>>& triangles) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  edges.reserve(3 * triangles.size());
  for (const auto& triangle : triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      edges.push_back(std::minmax({triangle[c], triangle[(c + 1) % 3]}));
    }
  }
  parallel_sort(edges.begin(), edges.end(), std::less<>());
  SurfaceTopology topology;
  for (std::size_t n = 0; n < edges.size();) {
    std::size_t end = n + 1;
    while (end < edges.size() && edges[end] == edges[n]) ++end;
    topology.open_edges += (end - n) % 2 == 1 ? 1 : 0;
    topology.pinched_edges += end - n >= 4 ? 1 : 0;
    n = end;
  }
  return topology;
}

std::int64_t count_pieces(const SolidMesh& mesh) {
  std::vector<std::int32_t> root(mesh.element_count());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](std::int32_t n) {
    while (root[std::size_t(n)] != n) {
      n = root[std::size_t(n)] = root[std::size_t(root[std::size_t(n)])];
    }
    return n;
  };
  std::int64_t pieces = std::int64_t(root.size());
  for_each_face(sorted_faces(mesh), [&](const ElementFace& face, const ElementFace* other) {
    if (other == nullptr) return;
    const std::int32_t a = find(face.element), b = find(other->element);
    if (a == b) return;
    root[std::size_t(std::max(a, b))] = std::min(a, b);
    --pieces;
  });
  return pieces;
}

}  // namespace supple
