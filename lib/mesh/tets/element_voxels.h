// Voxel centres in the elements of a mesh.
#pragma once

#include <array>
#include <cmath>

#include "volumes/geometry/geometry.h"
#include "volumes/grid/voxel_sets.h"
#include "volumes/io/solid/solid_mesh.h"

namespace supple {

/// A tetrahedron of either orientation in the grid of a volume, as four half-spaces.
class IndexTet {
 public:
  explicit IndexTet(const std::array<Vec3d, 4>& corners) : m_lo(1e300), m_hi(-1e300) {
    for (std::size_t f = 0; f < 4; ++f) {
      const Vec3d &a = corners[(f + 1) & 3U], &b = corners[(f + 2) & 3U],
                  &c = corners[(f + 3) & 3U];
      Vec3d normal = (b - a).cross(c - a);
      if (normal.dot(corners[f] - a) < 0) normal = -normal;
      m_normals[f] = normal;
      m_depths[f] = normal.dot(a);
      m_small[f] = 1e-9 * normal.length();
      for (int x = 0; x < 3; ++x) {
        m_lo[x] = std::min(m_lo[x], corners[f][x]);
        m_hi[x] = std::max(m_hi[x], corners[f][x]);
      }
    }
  }

  /// Calls visit(voxel) for the centres within, those on faces included.
  template <class Visit>
  void for_each_voxel(const Visit& visit) const {
    for (int k = int(std::ceil(m_lo.z)); k <= int(std::floor(m_hi.z)); ++k) {
      for (int j = int(std::ceil(m_lo.y)); j <= int(std::floor(m_hi.y)); ++j) {
        double from = m_lo.x, to = m_hi.x;
        for (std::size_t f = 0; f < 4; ++f) {
          const double rest = m_depths[f] - m_normals[f].y * j - m_normals[f].z * k;
          const double along = m_normals[f].x;
          if (along > m_small[f]) {
            from = std::max(from, rest / along);
          } else if (along < -m_small[f]) {
            to = std::min(to, rest / along);
          } else if (rest > m_small[f]) {
            to = from - 1;
          }
        }
        if (from > to + 2e-9) continue;
        for (int i = int(std::ceil(from - 1e-9)); i <= int(std::floor(to + 1e-9)); ++i) {
          visit(Vec3i(i, j, k));
        }
      }
    }
  }

 private:
  std::array<Vec3d, 4> m_normals;  // inwards
  std::array<double, 4> m_depths{};
  std::array<double, 4> m_small{};  // for a face parallel to x, and for centres on it
  Vec3d m_lo, m_hi;
};

/// Nodes in the grid of a volume.
inline std::vector<Vec3d> index_places(const SolidMesh& mesh, const Geometry& geometry) {
  std::vector<Vec3d> places;
  places.reserve(mesh.nodes_lps_mm.size());
  for (const Vec3d& node : mesh.nodes_lps_mm) places.push_back(geometry.index_from_world(node));
  return places;
}

/// Calls visit(voxel) once for each centre in an element; a hexahedron is six tetrahedra. `places`
/// are those of index_places().
template <class Visit>
void for_each_voxel(const SolidMesh& mesh, std::size_t element, const std::vector<Vec3d>& places,
                    const Visit& visit) {
  const auto tet_of = [&](std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
    return IndexTet({places[std::size_t(a)], places[std::size_t(b)], places[std::size_t(c)],
                     places[std::size_t(d)]});
  };
  if (element < mesh.tets.size()) {
    const auto& t = mesh.tets[element];
    return tet_of(t[0], t[1], t[2], t[3]).for_each_voxel(visit);
  }
  const auto& h = mesh.hexes[element - mesh.tets.size()];
  std::vector<Vec3i> voxels;
  for (const auto& [b, c] : {std::pair(1, 2), {2, 3}, {3, 7}, {7, 4}, {4, 5}, {5, 1}}) {
    tet_of(h[0], h[std::size_t(b)], h[std::size_t(c)], h[6])
        .for_each_voxel([&](const Vec3i& voxel) { voxels.push_back(voxel); });
  }
  sort_unique(voxels);  // centres on faces between the six come several times
  for (const Vec3i& voxel : voxels) visit(voxel);
}

/// Calls visit(node) for the corners of an element.
template <class Visit>
void for_each_corner(const SolidMesh& mesh, std::size_t element, const Visit& visit) {
  if (element < mesh.tets.size()) {
    for (const std::int32_t node : mesh.tets[element]) visit(std::size_t(node));
  } else {
    for (const std::int32_t node : mesh.hexes[element - mesh.tets.size()]) {
      visit(std::size_t(node));
    }
  }
}

}  // namespace supple
