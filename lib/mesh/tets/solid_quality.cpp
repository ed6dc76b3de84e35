#include "lib/mesh/tets/solid_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/mesh/tets/solid_faces.h"
#include "lib/mesh/tets/tet_shape.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

constexpr int kHexEdges[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                  {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
/// Six tetrahedra around the diagonal from corner 0 to corner 6.
constexpr int kHexTets[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6},
                                {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};

/// Sums and extremes over some elements.
struct Shapes {
  double least_cosine = 1, largest_cosine = -1;
  double aspects = 0, largest_aspect = 0;
  double edges = 0, shortest = std::numeric_limits<double>::infinity(), longest = 0;
  std::int64_t edge_count = 0;

  void add_edges(const Vec3d* corners, const int (*ends)[2], int count) {
    for (int n = 0; n < count; ++n) {
      const double length = (corners[ends[n][1]] - corners[ends[n][0]]).length();
      edges += length;
      shortest = std::min(shortest, length);
      longest = std::max(longest, length);
    }
    edge_count += count;
  }
  void add(const Shapes& other) {
    least_cosine = std::min(least_cosine, other.least_cosine);
    largest_cosine = std::max(largest_cosine, other.largest_cosine);
    aspects += other.aspects;
    largest_aspect = std::max(largest_aspect, other.largest_aspect);
    edges += other.edges;
    shortest = std::min(shortest, other.shortest);
    longest = std::max(longest, other.longest);
    edge_count += other.edge_count;
  }
};

template <std::size_t corners>
std::array<Vec3d, corners> places_of(const SolidMesh& mesh,
                                     const std::array<std::int32_t, corners>& nodes) {
  std::array<Vec3d, corners> places;
  for (std::size_t c = 0; c < corners; ++c) places[c] = mesh.nodes_lps_mm[std::size_t(nodes[c])];
  return places;
}

double longest_edge(const Vec3d* corners, const int (*ends)[2], int count) {
  double longest = 0;
  for (int n = 0; n < count; ++n) {
    longest = std::max(longest, (corners[ends[n][1]] - corners[ends[n][0]]).length());
  }
  return longest;
}

void add_tet(const std::array<Vec3d, 4>& p, Shapes& shapes) {
  const TetAngles angles(p);
  shapes.least_cosine = std::min(shapes.least_cosine, angles.least_cosine);
  shapes.largest_cosine = std::max(shapes.largest_cosine, angles.largest_cosine);
  shapes.add_edges(p.data(), kTetEdges, 6);
  const double area = angles.areas[0] + angles.areas[1] + angles.areas[2] + angles.areas[3];
  const double radius = 3 * tet_volume(p) / area;
  const double aspect = longest_edge(p.data(), kTetEdges, 6) / (2 * std::sqrt(6.0) * radius);
  shapes.aspects += aspect;
  shapes.largest_aspect = std::max(shapes.largest_aspect, aspect);
}

void add_hex(const std::array<Vec3d, 8>& p, Shapes& shapes) {
  Shapes own;
  own.add_edges(p.data(), kHexEdges, 12);
  own.aspects = own.largest_aspect = own.longest / own.shortest;
  shapes.add(own);
}

Shapes shapes_of(const SolidMesh& mesh) {
  constexpr std::size_t kBlock = 4096;
  const std::size_t count = mesh.element_count(), tets = mesh.tets.size();
  std::vector<Shapes> blocks((count + kBlock - 1) / kBlock);
  parallel_for(blocks.size(), [&](std::size_t b) {
    for (std::size_t e = kBlock * b; e < std::min(count, kBlock * (b + 1)); ++e) {
      if (e < tets) {
        add_tet(places_of(mesh, mesh.tets[e]), blocks[b]);
      } else {
        add_hex(places_of(mesh, mesh.hexes[e - tets]), blocks[b]);
      }
    }
  });
  Shapes shapes;
  for (const Shapes& block : blocks) shapes.add(block);
  return shapes;
}

/// Nodes at which three regions meet, the outside among them.
std::vector<std::uint8_t> junction_nodes(const SolidMesh& mesh) {
  constexpr std::int32_t kNone = std::numeric_limits<std::int32_t>::min();
  std::vector<std::array<std::int32_t, 2>> first(mesh.nodes_lps_mm.size(), {kNone, kNone});
  std::vector<std::uint8_t> is_junction(first.size(), 0);
  const auto meet = [&](std::size_t node, std::int32_t region) {
    for (std::int32_t& known : first[node]) {
      if (known == kNone) known = region;
      if (known == region) return;
    }
    is_junction[node] = 1;
  };
  for (const auto& [regions, faces] : borders_of_regions(mesh)) {
    for (const auto& triangle : faces.triangles) {
      for (const std::int32_t node : triangle) {
        meet(std::size_t(node), regions.first);
        meet(std::size_t(node), regions.second);
      }
    }
  }
  return is_junction;
}

void measure_junctions(const SolidMesh& mesh, SolidQuality& quality) {
  const std::vector<std::uint8_t> is_junction = junction_nodes(mesh);
  for (const auto& tet : mesh.tets) {
    const bool is_there = std::any_of(tet.begin(), tet.end(), [&](std::int32_t node) {
      return is_junction[std::size_t(node)] != 0;
    });
    if (!is_there) continue;
    const TetAngles angles(places_of(mesh, tet));
    ++quality.junction_tets;
    quality.least_junction_deg =
        std::min(quality.least_junction_deg, angle_deg(angles.largest_cosine));
    quality.largest_junction_deg =
        std::max(quality.largest_junction_deg, angle_deg(angles.least_cosine));
  }
}

}  // namespace

std::vector<double> volumes_mm3(const SolidMesh& mesh) {
  std::vector<double> volumes(mesh.element_count());
  parallel_for(volumes.size(), Grain{4096}, [&](std::size_t e) {
    if (e < mesh.tets.size()) {
      volumes[e] = tet_volume(places_of(mesh, mesh.tets[e]));
      return;
    }
    const auto p = places_of(mesh, mesh.hexes[e - mesh.tets.size()]);
    for (const auto& tet : kHexTets) {
      volumes[e] += tet_volume({p[std::size_t(tet[0])], p[std::size_t(tet[1])],
                                p[std::size_t(tet[2])], p[std::size_t(tet[3])]});
    }
  });
  return volumes;
}

SolidQuality quality_of(const SolidMesh& mesh) {
  SolidQuality quality;
  const Shapes shapes = shapes_of(mesh);
  if (!mesh.tets.empty()) {
    quality.least_dihedral_deg = angle_deg(shapes.largest_cosine);
    quality.largest_dihedral_deg = angle_deg(shapes.least_cosine);
  }
  const std::vector<double> volumes = volumes_mm3(mesh);
  quality.mean_aspect = shapes.aspects / double(volumes.size());
  quality.largest_aspect = shapes.largest_aspect;
  quality.shortest_edge_mm = shapes.shortest;
  quality.mean_edge_mm = shapes.edges / double(shapes.edge_count);
  quality.longest_edge_mm = shapes.longest;
  quality.least_volume_mm3 = *std::min_element(volumes.begin(), volumes.end());
  quality.largest_volume_mm3 = *std::max_element(volumes.begin(), volumes.end());
  double sum = 0;
  for (std::size_t e = 0; e < volumes.size(); ++e) {
    const std::int32_t region = mesh.region_of.empty() ? 1 : mesh.region_of[e];
    quality.volume_mm3[region] += volumes[e];
    ++quality.elements[region];
    quality.turned_inside_out += volumes[e] > 0 ? 0 : 1;
    sum += volumes[e];
  }
  quality.mean_volume_mm3 = sum / double(volumes.size());
  if (quality.elements.size() > 1) measure_junctions(mesh, quality);
  return quality;
}

}  // namespace supple
