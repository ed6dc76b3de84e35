// Offsets that each sample finds for itself, in bricks in which nothing on a lattice could be
// interpolated: where they jump (split_offsets.h), or before an inverse exists (forward_offsets.h).
#pragma once

#include "volumes/grid/brick_topology.h"

namespace supple {

class PointwiseOffsets {
 public:
  struct Sample {
    Vec3d offset{0, 0, 0};
    int piece = -1;  // where the sample was found; -1: nowhere
  };

  virtual ~PointwiseOffsets() = default;

  /// The bricks, all of their voxels active.
  const BrickTopology& bricks() const { return m_bricks; }

  /// Offset and piece at x, in index space, inside the cells of brick b. False in a gap and in the
  /// void. `found` may hold a sample found nearby, to begin with.
  virtual bool sample(std::size_t b, const Vec3d& x, Sample& found) const = 0;
  /// Box in index space around all that samples of brick b can read; lo > hi: nothing.
  virtual void source_box(std::size_t b, Vec3d& lo, Vec3d& hi) const = 0;
  /// Cells of brick b in which offsets may as well be interpolated between nodes of the lattice, as
  /// in all other bricks. Null: none.
  virtual const BrickMask* interpolated(std::size_t /*b*/) const { return nullptr; }
  /// (I + grad o)^T g of a sample found at x in this piece, which reads the source at y.
  virtual Vec3d pull_back(int piece, const Vec3d& x, const Vec3d& y,
                          const Vec3d& gradient) const = 0;
  /// The same with differences over half a voxel to both sides, on the piece's side of all jumps:
  /// derivatives that do not jump where pieces meet, for six more samples.
  Vec3d pull_back_smoothly(int piece, const Vec3d& x, const Vec3d& y, const Vec3d& gradient) const;
  /// The face behind which a sample found at x in this piece lies, which reads the source at y: its
  /// normal, into the piece, in mm per voxel, and the distance to it in mm, as in the body before
  /// it was split. False: none is known.
  virtual bool face(int piece, const Vec3d& x, const Vec3d& y, Vec3d& normal,
                    double& depth_mm) const;

  /// The same with the normal of the face in the source, in mm per voxel, where it is known there;
  /// piece -1: of a sample in a cell that is interpolated.
  virtual bool face_in_source(int piece, const Vec3d& y, Vec3d& normal, double& depth_mm) const;

 protected:
  /// The offset at a place within a voxel of a piece, on its side of all jumps. False: none.
  virtual bool offset_beside(int piece, const Vec3d& place, Vec3d& offset) const;
  /// All voxels of the bricks at these sorted origins.
  void set_bricks(std::vector<Vec3i> origins);

 private:
  BrickTopology m_bricks;
};

}  // namespace supple
