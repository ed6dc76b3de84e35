// The body-centred cubic lattice: corners and centres of cubes, joined to congruent tetrahedra.
// Every vertex has six long edges, as long as the cubes' own, and eight short ones to the other
// kind of vertex, sqrt(3)/2 of that. Dihedral angles are 60 and 90 degrees.
#pragma once

#include <array>
#include <cstdint>

#include "volumes/geometry/geometry.h"

namespace supple {

/// A vertex by its place in halves of the cubes' edge: all even at corners, all odd at centres.
using LatticePlace = Vec3i;

/// The edges that a vertex owns: three long ones in positive directions, and of a centre eight
/// short ones.
constexpr int kLongEdges = 3, kOwnedEdges = 11;

/// Steps to the other ends of these edges, in halves of the cubes' edge.
inline constexpr std::array<std::array<int, 3>, kOwnedEdges> kEdgeSteps = {{{2, 0, 0},
                                                                            {0, 2, 0},
                                                                            {0, 0, 2},
                                                                            {-1, -1, -1},
                                                                            {1, -1, -1},
                                                                            {-1, 1, -1},
                                                                            {1, 1, -1},
                                                                            {-1, -1, 1},
                                                                            {1, -1, 1},
                                                                            {-1, 1, 1},
                                                                            {1, 1, 1}}};
inline Vec3i edge_step(int edge) {
  const auto& step = kEdgeSteps[std::size_t(edge)];
  return {step[0], step[1], step[2]};
}

class BccLattice {
 public:
  /// Covers a box of voxels and half a voxel around it, with a cube to spare on every side, along
  /// the axes of the volume. Throws InputError, field "spacing", where it would have more than
  /// kMostVertices.
  BccLattice(const Geometry& geometry, const IndexBox& box, double spacing_mm);

  static constexpr std::int64_t kMostVertices = 300'000'000;

  double spacing_mm() const { return m_spacing; }
  /// Cubes along each axis.
  const Vec3i& cubes() const { return m_cubes; }
  std::int64_t vertex_count() const { return 2 * m_per_kind; }

  bool contains(const LatticePlace& place) const {
    const int odd = place.x & 1;
    return place.x >= odd && place.y >= odd && place.z >= odd && place.x + odd <= 2 * m_cubes.x &&
           place.y + odd <= 2 * m_cubes.y && place.z + odd <= 2 * m_cubes.z;
  }
  /// Corners come first, then centres, i fastest.
  std::int64_t id(const LatticePlace& place) const {
    return (place.x & 1) * m_per_kind +
           ((place.z >> 1) * std::int64_t(m_cubes.y + 1) + (place.y >> 1)) * (m_cubes.x + 1) +
           (place.x >> 1);
  }
  LatticePlace place(std::int64_t id) const;
  /// Steps of id along the three axes, for two halves of the cubes' edge.
  std::int64_t stride(int axis) const {
    return axis == 0   ? 1
           : axis == 1 ? m_cubes.x + 1
                       : std::int64_t(m_cubes.x + 1) * (m_cubes.y + 1);
  }

  /// Places in the volume's grid and in space, linear in `half_edges`.
  Vec3d index_at(const Vec3d& half_edges) const;
  Vec3d lps_at(const Vec3d& half_edges) const;

 private:
  Geometry m_geometry;
  double m_spacing;
  Vec3i m_cubes{0, 0, 0};
  std::int64_t m_per_kind = 0;
  Vec3d m_origin_mm{0, 0, 0};     // along m_axes, from the volume's first voxel
  std::array<Vec3d, 3> m_axes;    // of unit length, perpendicular, right-handed
  Vec3d m_index_origin{0, 0, 0};  // index_at(0)
  std::array<Vec3d, 3> m_index_axes;
};

}  // namespace supple
