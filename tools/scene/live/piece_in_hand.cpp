#include "tools/scene/live/piece_in_hand.h"

#include "lib/session/handles/handles.h"
#include "volumes/base/error.h"

namespace supple::tools {

namespace {

/// Turns that are smaller are rounding.
constexpr double kLeastDegrees = 1e-6;

/// The inverse of lps_of(): a direction in the frame of a handle.
Vec3d in_frame(const Vec3d& lps, PlaceFrame frame, const Geometry& geometry) {
  if (frame == PlaceFrame::voxel) {
    return geometry.index_vector_from_world(lps) * geometry.spacing_mm();
  }
  return frame == PlaceFrame::lps ? lps : Vec3d(-lps.x, -lps.y, lps.z);
}

int number_at(const Body& body, const Vec3i& voxel) {
  Slot slot = 0;
  return slot_of(body.elements, voxel, slot) ? body.rigid.at(slot) : -1;
}

}  // namespace

std::shared_ptr<const PieceInHand> PieceInHand::of(const Step& grab, const Session& session) {
  if (!grab.drags.front().placed->rigid_at) return nullptr;
  const Step found = on_grid(grab, session.geometry());
  PieceInHand held(*found.drags.front().selection->rigid_at);
  if (number_at(session.body(), held.m_voxel) < 0) return nullptr;
  held.m_grabbed = held.piece(session).pose.turn;
  return std::make_shared<const PieceInHand>(held);
}

const RigidPiece& PieceInHand::piece(const Session& session) const {
  const Body& body = session.body();
  const int number = number_at(body, m_voxel);
  if (number < 0) throw InputError({"", "rigid_at", "a piece that is gone", "one of the body"});
  return body.rigid.list[std::size_t(number)];
}

Turn PieceInHand::turn_since(const Session& session) const {
  return (piece(session).pose.turn * m_grabbed.inverse()).unit();
}

double PieceInHand::turned_deg(const Session& session) const {
  return turn_since(session).angle_deg();
}

bool PieceInHand::add_turn(const LiveEvent& event, const Session& session, Drag& handle,
                           Value& keys) const {
  const Geometry& geometry = session.geometry();
  const PlaceFrame frame = handle.placed->frame;
  Turn asked;
  if (event.turn != Vec3d(0)) {
    asked = turn_about(lps_of(event.turn, frame, geometry), event.turn.length());
  }
  const Turn left = (asked * turn_since(session).inverse()).unit();
  const double degrees = left.angle_deg();
  if (degrees < kLeastDegrees) return false;
  handle.placed->rotate_deg = degrees;
  handle.placed->axis = in_frame(left.axis(), frame, geometry);
  keys["rotate"] = degrees;
  keys["axis"] = *handle.placed->axis;
  handle.slides = false;  // what turns does not slide
  keys.erase("slide");
  return true;
}

void PieceInHand::add_joint(double joint_mm, const Session& session, const Drag& handle,
                            Step& step) const {
  ChosenPart part;
  part.name = piece(session).name;
  part.placed = static_cast<const PlacedSelection&>(*handle.placed);
  Value keys = Value::Entries();
  for (const char* const key : {"frame", "rigid_at"}) {
    const Value& value = handle.placed->keys[key];
    if (!value.is_null()) keys[key] = value;
  }
  keys["name"] = part.name;
  part.placed->keys = keys;
  step.rigid.parts.push_back(std::move(part));
  step.rigid.joint_mm = joint_mm;
  step.keys["rigid"] = Value::List{std::move(keys)};
  step.keys["joint"] = joint_mm;
}

double asked_deg(const LiveEvent& event) {
  return turn_about(Vec3d(1, 0, 0), event.turn.length()).unit().angle_deg();
}

}  // namespace supple::tools
