// The faces that an opened cut shows: a point in the middle of every cut link whose ends have moved
// apart, each with the plane that fits the points around it. A cut along a lattice plane has its
// face exactly there, in the middle of the links; an oblique one is smooth, though its links are
// stairs: within each cell its face is where the distances of the corners from those planes
// interpolate to zero, between the ends of every cut link.
// Cost: about 4 µs and 0.5 kB per point once, 0.1 µs per look-up near a face.
#pragma once

#include <vector>

#include "volumes/field/cuts/cut_body.h"
#include "volumes/geometry/geometry.h"

namespace supple {

class CutFaces {
 public:
  /// Sides closer than `closed` voxels show no face.
  CutFaces(const std::vector<TornCell>& cells, const Geometry& geometry, double closed);

  struct Depth {
    double mm;
    Vec3d gradient;  // mm per voxel
  };
  /// Distance of X, index space at rest, from the nearest open face beside it, positive on the side
  /// on which `inside` lies; infinite, without gradient, where none is within four voxels.
  Depth depth(const Vec3d& X, const Vec3d& inside) const;

  /// At the corners of a torn cell, the distance in voxels from the face of one side; positive at
  /// its own corners and there alone.
  std::array<float, 8> depths_of_corners(const TornCell& cell, int side) const;

 private:
  struct Point {
    Vec3d at;         // index space
    Vec3d normal_mm;  // (X - at) . normal_mm is the distance from its plane in mm
    Vec3d across;     // the normal's direction, length 1
    bool is_open = false;
  };
  void fit_plane(Point& point, int axis, const Geometry& geometry) const;
  void list_seen(int point);
  bool signed_distance(const Vec3d& X, const Vec3d& orientation, double& distance) const;
  template <class Visit>
  void for_near(const Vec3d& X, Visit&& visit) const;

  std::vector<Point> m_points;
  std::unordered_map<Vec3i, std::vector<int>, VoxelHash> m_blocks;  // of four voxels
  /// The open points that places in a block of two voxels may know.
  std::unordered_map<Vec3i, std::vector<int>, VoxelHash> m_seen;
};

}  // namespace supple
