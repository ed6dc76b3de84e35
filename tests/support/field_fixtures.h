// Topologies and fields that the tests of this folder share.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <tuple>

#include "volumes/field/offset_field.h"

namespace supple::test {

using Voxel = std::tuple<int, int, int>;
using VoxelField = std::map<Voxel, Vec3f>;

inline Voxel key(const Vec3i& v) {
  return {v.x, v.y, v.z};
}

/// The voxels of the box lo to hi for which `inside` is true.
inline BrickTopology topology_where(const Vec3i& lo, const Vec3i& hi,
                                    const std::function<bool(const Vec3i&)>& inside) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (int x = lo.x & ~7; x <= hi.x; x += 8) {
    for (int y = lo.y & ~7; y <= hi.y; y += 8) {
      for (int z = lo.z & ~7; z <= hi.z; z += 8) {
        BrickMask mask{};
        for (int offset = 0; offset < kBrickVoxels; ++offset) {
          const Vec3i v = Vec3i(x, y, z) + brick_local(offset);
          if (IndexBox{lo, hi}.contains(v) && inside(v)) mask_set(mask, offset);
        }
        origins.push_back({x, y, z});
        masks.push_back(mask);
      }
    }
  }
  return {origins, masks};
}

inline BrickTopology box_topology(const Vec3i& lo, const Vec3i& hi) {
  return topology_where(lo, hi, [](const Vec3i&) { return true; });
}

template <class Visit>
void for_each_slot(const BrickTopology& topology, Visit&& visit) {
  for (std::size_t b = 0; b < topology.brick_count(); ++b) {
    for_each_active(topology.mask(b), [&](int offset) {
      visit(topology.origin(b) + brick_local(offset), b * kBrickVoxels + offset);
    });
  }
}

inline VectorBricks field_on(const BrickTopology& topology,
                             const std::function<Vec3f(const Vec3i&)>& value) {
  VectorBricks field{topology, BrickVectors(topology.brick_count())};
  for_each_slot(topology,
                [&](const Vec3i& v, std::size_t slot) { field.vectors.set(slot, value(v)); });
  return field;
}

inline VoxelField to_map(const VectorBricks& field) {
  VoxelField map;
  for_each_slot(field.topology,
                [&](const Vec3i& v, std::size_t slot) { map[key(v)] = field.vectors.at(slot); });
  return map;
}

inline Geometry unit_geometry(const Vec3i& dims) {
  return {dims, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}}};
}

inline Vec3f random_vector(std::mt19937& random, float size) {
  std::uniform_real_distribution<float> component(-size, size);
  return {component(random), component(random), component(random)};
}

inline Displacement displacement_on(const BrickTopology& topology,
                                    const std::function<Vec3f(const Vec3i&)>& u) {
  return {unit_geometry(topology.active_bounds().hi + Vec3i(1)), field_on(topology, u)};
}

/// Noise of at most `size` per component: links keep [1 - 2 size, 1 + 2 size] of their length and
/// shear by at most 2 size, so that no cell folds below size = 1/6 (design.md section 2).
inline Displacement noisy_displacement(std::mt19937& random, const BrickTopology& topology,
                                       float size, const Vec3f& shift = Vec3f(0)) {
  return displacement_on(topology,
                         [&](const Vec3i&) { return shift + random_vector(random, size); });
}

/// u at a place, carried on linearly along each axis for half a voxel beyond the border of `dims`.
inline bool sample_with_border(const VectorBricks& u, const Vec3i& dims, const Vec3d& pos,
                               Vec3d& value) {
  for (int a = 0; a < 3; ++a) {
    const double last = dims[a] - 1, border = pos[a] < 0 ? 0 : last;
    const double beyond = std::abs(pos[a] - border);
    if ((pos[a] >= 0 && pos[a] <= last) || last == 0 || beyond > 0.5) continue;
    Vec3d at = pos, next = pos, u_at, u_next;
    at[a] = border;
    next[a] = border + (pos[a] < 0 ? 1 : -1);
    if (!sample_with_border(u, dims, at, u_at)) return false;
    if (!sample_with_border(u, dims, next, u_next)) return false;
    value = u_at + (u_at - u_next) * beyond;
    return true;
  }
  return u.sample(pos, value);
}

/// max |o + u(x + o)| over the nodes of `o`; positions rounded off the border are put back on it.
inline double max_residual(const VectorBricks& u, const VectorBricks& o) {
  double worst = 0;
  for_each_slot(o.topology, [&](const Vec3i& x, std::size_t slot) {
    const Vec3d offset(o.vectors.at(slot));
    const Vec3i dims = u.topology.active_bounds().hi + Vec3i(1);
    Vec3d pos = Vec3d(x) + offset, moved;
    if (!sample_with_border(u, dims, pos, moved)) {
      for (int a = 0; a < 3; ++a) {
        const double nearest = std::round(pos[a]);
        if (std::abs(pos[a] - nearest) < 1e-4) pos[a] = nearest;
      }
      if (!u.sample(pos, moved)) moved = Vec3d(1e30);
    }
    worst = std::max(worst, (offset + moved).length());
  });
  return worst;
}

}  // namespace supple::test
