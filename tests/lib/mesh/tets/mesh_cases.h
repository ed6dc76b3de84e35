// Masks for tests of meshers, and what every mesh keeps.
#pragma once

#include <algorithm>
#include <map>
#include <random>

#include "lib/mesh/tets/make_solid.h"
#include "lib/mesh/tets/solid_faces.h"
#include "lib/mesh/tets/solid_quality.h"
#include "volumes/grid/voxel_sets.h"

namespace supple::test {

/// A full affine whose index axes are perpendicular, right- or left-handed.
inline Geometry random_geometry(std::mt19937& random, const Vec3i& dims) {
  std::uniform_real_distribution<double> size(0.7, 1.6), angle(0, 360);
  const Turn turn = turn_about({size(random), size(random), size(random)}, angle(random));
  std::array<Vec3d, 3> axes = {turn({size(random), 0, 0}), turn({0, size(random), 0}),
                               turn({0, 0, size(random)})};
  if (random() % 2 == 0) axes[2] = -axes[2];
  return {dims, Vec3d(size(random), -40 * size(random), 7), axes};
}

/// Voxels that hang together by faces, edges or corners: a walk; or sheets of one voxel, islands,
/// noise, all of them up to the border.
inline BrickTopology random_voxels(std::mt19937& random, const Vec3i& dims) {
  std::vector<Vec3i> voxels;
  const auto any = [&](int below) { return int(random() % unsigned(below)); };
  const auto inside = [&](Vec3i v) {
    for (int a = 0; a < 3; ++a) v[a] = std::clamp(v[a], 0, dims[a] - 1);
    return v;
  };
  switch (any(4)) {
    case 0: {
      Vec3i at(any(dims.x), any(dims.y), any(dims.z));
      for (int n = 30 + any(400); n > 0; --n) {
        voxels.push_back(at);
        at = inside(at + Vec3i(any(3) - 1, any(3) - 1, any(3) - 1));
      }
      break;
    }
    case 1: {
      const Vec3i normal(any(5) - 2, any(5) - 2, 1 + any(2));
      for (int i = 0; i < dims.x; ++i) {
        for (int j = 0; j < dims.y; ++j) {
          voxels.push_back(inside({i, j, (normal.x * i + normal.y * j) / normal.z + dims.z / 2}));
        }
      }
      break;
    }
    case 2:
      for (int n = 1 + any(40); n > 0; --n) {
        voxels.push_back({any(dims.x), any(dims.y), any(dims.z)});
      }
      break;
    default:
      for (int n = 0; n < dims.x * dims.y * dims.z; ++n) {
        if (any(3) > 0) continue;
        voxels.push_back({n % dims.x, n / dims.x % dims.y, n / dims.x / dims.y});
      }
  }
  return topology_of(voxels);
}

inline VoxelMask ball(double radius, const Vec3d& spacing_mm) {
  std::vector<Vec3i> voxels;
  const int reach = 40;
  for (int i = -reach; i <= reach; ++i) {
    for (int j = -reach; j <= reach; ++j) {
      for (int k = -reach; k <= reach; ++k) {
        if ((Vec3d(i, j, k) * spacing_mm).length() <= radius) {
          voxels.push_back(Vec3i(reach) + Vec3i(i, j, k));
        }
      }
    }
  }
  const Geometry geometry(Vec3i(2 * reach + 1), Vec3d(0) - spacing_mm * double(reach),
                          {Vec3d(spacing_mm.x, 0, 0), {0, spacing_mm.y, 0}, {0, 0, spacing_mm.z}});
  return mask_of(geometry, topology_of(voxels));
}

inline double volume_of(const SolidMesh& mesh) {
  double sum = 0;
  for (const double volume : volumes_mm3(mesh)) sum += volume;
  return sum;
}

/// Throws the first fault of a mesh: two nodes at one place, a face of more than two elements, or
/// an open surface of it or of a region.
inline void require_conforming(const SolidMesh& mesh) {
  std::vector<Vec3d> nodes = mesh.nodes_lps_mm;
  std::sort(nodes.begin(), nodes.end(), [](const Vec3d& a, const Vec3d& b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
  });
  if (std::adjacent_find(nodes.begin(), nodes.end()) != nodes.end()) {
    throw Error("two nodes at one place");
  }
  std::vector<std::array<std::int32_t, 3>> all;
  for (const auto& tet : mesh.tets) {
    for (std::size_t f = 0; f < 4; ++f) {
      all.push_back({tet[(f + 1) & 3U], tet[(f + 2) & 3U], tet[(f + 3) & 3U]});
      std::sort(all.back().begin(), all.back().end());
    }
  }
  std::sort(all.begin(), all.end());
  for (std::size_t n = 2; n < all.size(); ++n) {
    if (all[n] == all[n - 2]) throw Error("a face of three elements");
  }
  std::map<std::int32_t, std::vector<std::array<std::int32_t, 3>>> around;
  for (const auto& [regions, faces] : borders_of_regions(mesh)) {
    for (const std::int32_t region : {regions.first, regions.second}) {
      auto& triangles = around[region];
      triangles.insert(triangles.end(), faces.triangles.begin(), faces.triangles.end());
    }
  }
  for (const auto& [region, triangles] : around) {
    if (topology_of(triangles).open_edges > 0) throw Error("an open surface");
  }
}

}  // namespace supple::test
