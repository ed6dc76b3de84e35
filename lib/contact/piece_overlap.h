// How deep rigid pieces lie in each other: the judge of their contact, which shares nothing with
// it.
//
// Every element of a piece counts, where its offset puts it. The motion of another piece is fitted
// to the offsets of its elements and taken back from there, and unit cubes around voxels at rest
// are compared. Cost: about 1 us per element and piece within whose box it is, and 0.2 us to know.
#pragma once

#include <unordered_set>
#include <vector>

#include "lib/body/body.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

class OverlapJudge {
 public:
  /// Judges the pieces where they are now.
  explicit OverlapJudge(const Body& body);

  /// The deepest overlap of voxels of two pieces, in voxels; 0 where none overlap.
  double deepest() const;
  /// The deepest overlap of pieces (in Body::rigid) with others, on a way that they go and others
  /// do not: at `samples` equal parts of it, up to the first that is deeper than `enough`.
  double deepest_on_way(const std::vector<std::size_t>& moved, const RigidMotion& way, int samples,
                        double enough = 1) const;

 private:
  using VoxelSet = std::unordered_set<Vec3i, VoxelHash>;
  struct Bone {
    VoxelSet voxels;
    std::vector<Vec3d> places_mm;  // where its voxels are
    Vec3i lo, hi;
    RigidMotion back;  // from where the bone is to where it was, in mm
  };
  double overlap_in(const Bone& bone, const Vec3d& place_mm) const;

  const Geometry m_geometry;
  std::vector<Bone> m_bones;
};

/// The result of OverlapJudge::deepest() for a body as it is.
double deepest_overlap(const Body& body);

}  // namespace supple
