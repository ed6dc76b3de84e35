// Labels of a volume that move as rigid bodies, each by the landmarks that lie in it, after Little,
// Hill and Hawkes, "Deformations incorporating rigid structures", Computer Vision and Image
// Understanding 66 (1997). A place outside takes the mean of their motions by 1 / distance^1.5
// (their eq. 9); `give()` is how much of anything else acts there, 0 in a region and near 1 far
// from all.
// Memory: 12 bytes per voxel of the label volume and label. Cost: 60 ns per place and label.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "volumes/field/offset_field.h"
#include "volumes/geometry/geometry.h"

namespace supple {

/// A label volume: the label of a voxel.
struct RegionLabels {
  Geometry geometry;
  std::function<std::int32_t(const Vec3i& voxel)> at;
};

class RigidRegions {
 public:
  /// `points` and `vectors`: landmarks, LPS mm, where they are and how far they move; those within
  /// a voxel of a region belong to it. `width_mm`: how far from a region half of anything else
  /// acts. Throws InputError for a label that no voxel has, and for one with fewer than three
  /// landmarks or with all of them on a line.
  RigidRegions(const RegionLabels& labels, const std::vector<std::int32_t>& rigid,
               const std::vector<Vec3d>& points, const std::vector<Vec3d>& vectors,
               double width_mm);

  /// The motion of the regions at x, and `give`.
  struct Motion {
    Vec3d vector{0, 0, 0};
    double give = 1;
  };
  Motion at(const Vec3d& x) const;
  /// How far a region's own landmarks are from where its motion takes them, mm: the largest.
  double largest_misfit_mm() const { return m_largest_misfit_mm; }
  /// Landmarks that lie in no region, by their numbers from 0.
  const std::vector<std::size_t>& outside() const { return m_outside; }

 private:
  struct Region {
    std::int32_t label = 0;
    VectorBricks to_nearest;  // voxels, to the nearest voxel of the region
    Turn turn;
    Vec3d middle{0, 0, 0}, shift{0, 0, 0};

    Vec3d way_of(const Vec3d& x) const { return turn.way_of(x - middle) + shift; }
  };
  double distance_mm(const Region& region, const Vec3d& x) const;
  void fit(Region& region, const std::vector<Vec3d>& from, const std::vector<Vec3d>& by);

  Geometry m_geometry;
  double m_width_mm = 10, m_largest_misfit_mm = 0;
  std::vector<Region> m_regions;
  std::vector<std::size_t> m_outside;
};

}  // namespace supple
