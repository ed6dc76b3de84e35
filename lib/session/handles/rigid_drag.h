// Handles that take hold of rigid pieces: each moves the whole piece as one rigid body.
#pragma once

#include <vector>

#include "lib/chainmail/drag.h"
#include "lib/session/handles/drag.h"

namespace supple {

/// Motion on which one or several drags take a piece.
struct PieceMotion {
  std::size_t piece;  // in Body::rigid
  std::size_t drag;   // the first that takes hold of it
  RigidMotion motion;
};

/// The motions of all pieces that two-sided drags touch; `regions` are the elements that the drags
/// grab. Several drags of one piece give the rigid motion nearest to theirs. Throws InputError for
/// a scale, and for drags that no rigid motion meets within half a voxel.
std::vector<PieceMotion> motions_of_pieces(const Body& body, const std::vector<Drag>& drags,
                                           const std::vector<Region>& regions);

/// The motion of a piece from where it is to where `motion` takes it from the pose in `start`.
PieceMotion continued(const PieceMotion& motion, const Body& start, const Body& body);

/// A handle that takes all elements of the piece to where the pose puts them. Throws InputError
/// beyond the range of offsets.
Handle handle_at(const Body& body, const RigidPiece& piece, const RigidPose& pose);
/// Makes a handle that takes the piece's elements to where that part of the motion does.
Handle handle_of(const Body& body, const PieceMotion& motion, double part);

/// Sets poses to those after that part of the motions.
void set_poses(Body& body, const std::vector<PieceMotion>& motions, double part);

}  // namespace supple
