// A rigid piece that a hand has grabbed by `rigid_at`: drags shift it and turn it about its middle,
// both counted from where it was grabbed, and a joint parts the tissue around it first. Functions
// that ask where it is throw InputError once it is no piece of the body any more.
#pragma once

#include <memory>

#include "lib/session/session.h"
#include "tools/scene/file/live_event.h"

namespace supple::tools {

class PieceInHand {
 public:
  /// The piece that the grab's handle takes whole; null where it takes no piece by `rigid_at`.
  static std::shared_ptr<const PieceInHand> of(const Step& grab, const Session& session);

  /// Angle of the turn since it was grabbed, in degrees.
  double turned_deg(const Session& session) const;
  /// Turns a drag's handle, and what its keys say of it, from where the piece is to where `event`
  /// asks; false where it is there.
  bool add_turn(const LiveEvent& event, const Session& session, Drag& handle, Value& keys) const;
  /// Parts the tissue around the piece, wherever another one is so near, before the step moves it.
  void add_joint(double joint_mm, const Session& session, const Drag& handle, Step& step) const;

 private:
  explicit PieceInHand(const Vec3i& voxel) : m_voxel(voxel) {}
  const RigidPiece& piece(const Session& session) const;
  Turn turn_since(const Session& session) const;

  Vec3i m_voxel;   // of the piece; its number in the body may change
  Turn m_grabbed;  // of the piece, when it was grabbed
};

/// Angle of an event's turn, 0 to 180 degrees.
double asked_deg(const LiveEvent& event);

}  // namespace supple::tools
