#include "lib/session/handles/rigid_drag.h"

#include <cmath>
#include <cstdlib>
#include <map>

#include "lib/session/handles/drag_handles.h"
#include "lib/session/handles/handle_motion.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

/// Several drags of one piece may differ from its motion by so much.
constexpr double kMisfitVoxels = 0.5;

Vec3d present_lps_mm(const Body& body, Slot slot) {
  return body.geometry.world_from_index(place_now(body, slot));
}

RigidMotion motion_of(const Body& body, const Drag& drag, const SlotSet& grabbed) {
  RigidMotion motion;
  motion.about_lps_mm =
      drag.motion.about_lps_mm ? *drag.motion.about_lps_mm : centre_lps_mm(body, grabbed);
  if (drag.motion.angle_deg != 0) {
    motion.turn = turn_about(drag.motion.axis_lps, drag.motion.angle_deg);
  }
  motion.shift_lps_mm =
      body.geometry.world_vector_from_index(drag.by_mm / body.geometry.spacing_mm());
  return motion;
}

/// A drag and the part of its elements that is in one piece.
struct Grip {
  std::size_t drag;
  RigidMotion motion;
  SlotSet elements;
};

RigidMotion motion_of_all(const Body& body, const RigidPiece& piece, const std::vector<Grip>& grips,
                          const std::vector<Drag>& drags, const std::vector<Region>& regions) {
  if (grips.size() == 1) return grips.front().motion;
  bool is_same = true;
  for (const Grip& grip : grips) {
    is_same = is_same && drags[grip.drag].motion.is_shift() &&
              drags[grip.drag].by_mm == drags[grips.front().drag].by_mm;
  }
  if (is_same) return grips.front().motion;
  RigidFit fit;
  for (const Grip& grip : grips) {
    grip.elements.for_each([&](Slot slot) {
      const Vec3d from = present_lps_mm(body, slot);
      fit.add(from, grip.motion(from));
    });
  }
  const RigidMotion motion = fit.motion();
  const double voxel_mm = [&] {
    const Vec3d spacing = body.geometry.spacing_mm();
    return std::min({spacing.x, spacing.y, spacing.z});
  }();
  double worst = 0;
  std::string found;
  for (const Grip& grip : grips) {
    grip.elements.for_each([&](Slot slot) {
      const Vec3d from = present_lps_mm(body, slot);
      const double misfit_mm = (motion(from) - grip.motion(from)).length();
      if (misfit_mm <= worst) return;
      worst = misfit_mm;
      found = "voxel " + voxel_text(voxel_of(body.elements, slot)) + " of " +
              regions[grip.drag].name() + " " + number_text(misfit_mm) +
              " mm from the nearest rigid motion";
    });
  }
  if (worst > kMisfitVoxels * voxel_mm) {
    throw InputError({"", "grab of rigid " + piece.name, found,
                      "handles that a rigid motion meets within half a voxel"});
  }
  return motion;
}

}  // namespace

std::vector<PieceMotion> motions_of_pieces(const Body& body, const std::vector<Drag>& drags,
                                           const std::vector<Region>& regions) {
  std::vector<PieceMotion> motions;
  if (body.rigid.empty()) return motions;
  std::map<int, std::vector<Grip>> grips;
  for (std::size_t n = 0; n < drags.size(); ++n) {
    if (drags[n].pushes) continue;
    const SlotSet grabbed = elements_of(body, regions[n], "grab");
    std::map<int, std::vector<Slot>> touched;
    grabbed.for_each([&](Slot slot) {
      const int piece = body.rigid.at(slot);
      if (piece >= 0) touched[piece].push_back(slot);
    });
    if (touched.empty()) continue;
    if (drags[n].motion.scale != Vec3d(1)) {
      throw InputError(
          {"", "grab " + regions[n].name(),
           "a scale of rigid " + body.rigid.list[std::size_t(touched.begin()->first)].name,
           "a shift or a turn"});
    }
    const RigidMotion motion = motion_of(body, drags[n], grabbed);
    for (auto& [piece, slots] : touched) {
      grips[piece].push_back({n, motion, SlotSet(std::move(slots))});
    }
  }
  for (const auto& [piece, list] : grips) {
    const RigidPiece& rigid = body.rigid.list[std::size_t(piece)];
    motions.push_back(
        {std::size_t(piece), list.front().drag, motion_of_all(body, rigid, list, drags, regions)});
  }
  return motions;
}

PieceMotion continued(const PieceMotion& motion, const Body& start, const Body& body) {
  const Geometry& geometry = body.geometry;
  const RigidPiece& piece = body.rigid.list[motion.piece];
  const RigidPose to = moved_by(motion.motion, start.rigid.list[motion.piece], geometry);
  PieceMotion rest = motion;
  rest.motion.turn = to.turn * piece.pose.turn.inverse();
  Vec3d now = piece.centre_index, way;
  for (int c = 0; c < 3; ++c) {
    const std::int64_t shift = piece.pose.shift_q[std::size_t(c)];
    now[c] += double(shift) / kFixedOne;
    way[c] = double(to.shift_q[std::size_t(c)] - shift) / kFixedOne;
  }
  rest.motion.about_lps_mm = geometry.world_from_index(now);
  rest.motion.shift_lps_mm = geometry.world_vector_from_index(way);
  return rest;
}

Handle handle_at(const Body& body, const RigidPiece& piece, const RigidPose& pose) {
  Handle handle(region_of(*piece.elements, body.elements, "rigid " + piece.name), {0, 0, 0});
  RigidPiece moved = piece;
  moved.pose = pose;
  const Turn turn = pose.turn * piece.pose.turn.inverse();
  handle.steps.emplace();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    handle.steps->after[axis] =
        body.geometry.index_vector_from_world(turn(body.geometry.axes_mm()[axis]));
  }
  const PoseOffsets offsets(body.geometry, moved);
  piece.elements->for_each([&](Slot slot) {
    const Vec3i voxel = voxel_of(body.elements, slot);
    const std::array<std::int64_t, 3> to = offsets(voxel);
    auto& by = handle.each_by_q.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      if (std::llabs(to[c]) > kMaxOffset) {
        throw InputError({"", "rigid " + piece.name,
                          "an offset of " + number_text(double(to[c]) / kFixedOne) +
                              " voxels along axis " + "ijk"[c] + " at voxel " + voxel_text(voxel),
                          "offsets within +-16383 voxels"});
      }
      by[c] = std::int32_t(to[c] - body.q[c].at(slot));
    }
  });
  return handle;
}

Handle handle_of(const Body& body, const PieceMotion& motion, double part) {
  const RigidPiece& piece = body.rigid.list[motion.piece];
  if (motion.motion.turns()) {
    return handle_at(body, piece, moved_by(motion.motion.part(part), piece, body.geometry));
  }
  Handle handle(region_of(*piece.elements, body.elements, "rigid " + piece.name), {0, 0, 0});
  const Vec3d by = body.geometry.index_vector_from_world(motion.motion.part(part).shift_lps_mm);
  handle.by_q = fixed_from_mm(by, Vec3d(1));
  return handle;
}

void set_poses(Body& body, const std::vector<PieceMotion>& motions, double part) {
  for (const PieceMotion& motion : motions) {
    if (!motion.motion.turns()) continue;
    RigidPiece& piece = body.rigid.list[motion.piece];
    piece.pose = moved_by(motion.motion.part(part), piece, body.geometry);
  }
}

}  // namespace supple
