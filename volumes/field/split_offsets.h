// Offsets that jump: a body that is cut open or falls into pieces (thesis section 3.3.5:
// "discontinuous sample paths can result in cut open objects").
//
// Around a jump the offsets of lattice nodes belong to different pieces, and values interpolated
// between them belong to neither. So the bricks that a jump passes through are set apart as split:
// each sample in one of their cells asks which piece it lies in and takes that piece's own offset,
// exactly. Faces are as sharp as the samples are close, gaps are empty, and bricks without a jump
// cost as much as without splitting.
#pragma once

#include "volumes/field/offset_field.h"

namespace supple {

/// The bricks are the split ones; among them those within three voxels behind a face, whose samples
/// are shaded as the face. Where pieces overlap the shortest offset wins.
class SplitOffsets : public PointwiseOffsets {
 public:
  /// The offset of one piece at x, which carries on smoothly beyond its faces; false where the
  /// piece has none.
  virtual bool offset_of(int piece, const Vec3d& x, Vec3d& offset) const = 0;
  /// The place of the source that is at x, a place in a split brick, to rounding. `is_ambiguous`:
  /// tissue from another place has come there, too, however near that is. False where nothing is,
  /// and where sample() knows no less.
  virtual bool place_at(const Vec3d& /*x*/, Vec3d& /*place*/, bool& /*is_ambiguous*/) const {
    return false;
  }
  /// Distance of x from the nearest face of the piece in mm, as in the body before it was split;
  /// negative outside, infinite for a piece whose faces are not known.
  virtual double depth_mm(int piece, const Vec3d& x) const = 0;
  /// grad depth_mm: the normal of the nearest face, into the piece, in mm per voxel. 0: no face.
  virtual Vec3d face_normal(int piece, const Vec3d& x) const;

  Vec3d pull_back(int piece, const Vec3d& x, const Vec3d& y, const Vec3d& gradient) const override;
  bool face(int piece, const Vec3d& x, const Vec3d& y, Vec3d& normal,
            double& depth_mm) const override;
};

}  // namespace supple
