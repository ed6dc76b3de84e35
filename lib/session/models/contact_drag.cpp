// Drags that keep apart what meets: rigid pieces on their way, then the sides of cuts.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "lib/body/kept_offsets.h"
#include "lib/chainmail/cut_contact.h"
#include "lib/session/handles/drag_handles.h"
#include "lib/session/models/drags.h"
#include "lib/session/rigid_request.h"
#include "lib/session/step_warnings.h"

namespace supple {

namespace {

struct StepStart {
  KeptOffsets offsets;
  Holds holds;
  std::vector<RigidPiece> pieces;
};

/// Halvings of the way, where limits forbid what pieces leave free.
constexpr int kHalvings = 8;

void multiply(EcmReport& report, std::int64_t parts, std::int64_t all) {
  const std::int64_t common = std::gcd(parts, all);
  report.fraction_numerator *= parts / common;
  report.fraction_denominator *= all / common;
  const std::int64_t both = std::gcd(report.fraction_numerator, report.fraction_denominator);
  report.fraction_numerator /= both;
  report.fraction_denominator /= both;
}

/// The pose after that part of the way of a piece: a handle's turn, or straight on.
RigidPose pose_at(const RigidPiece& start, const RigidPose& end, const RigidMotion* turn,
                  double part, const Geometry& geometry) {
  if (part == 0) return start.pose;
  if (part == 1) return end;
  if (turn != nullptr && turn->turns()) return moved_by(turn->part(part), start, geometry);
  RigidPose pose;
  pose.turn = start.pose.turn == end.turn ? end.turn : between(start.pose.turn, end.turn, part);
  for (std::size_t c = 0; c < 3; ++c) {
    pose.shift_q[c] =
        start.pose.shift_q[c] +
        std::int64_t(std::floor(double(end.shift_q[c] - start.pose.shift_q[c]) * part));
  }
  return pose;
}

std::vector<RigidPose> poses_of(const std::vector<RigidPiece>& pieces) {
  std::vector<RigidPose> poses;
  for (const RigidPiece& piece : pieces) poses.push_back(piece.pose);
  return poses;
}

void drop_shifts(std::vector<PieceMotion>& motions) {
  motions.erase(std::remove_if(motions.begin(), motions.end(),
                               [](const auto& motion) { return !motion.motion.turns(); }),
                motions.end());
}

/// The motion of a piece from one pose to another.
RigidMotion between(const RigidPose& from, const RigidPose& to, const RigidPiece& piece,
                    const Geometry& geometry) {
  const auto centre = [&](const RigidPose& pose) {
    Vec3d at = piece.centre_index;
    for (int c = 0; c < 3; ++c) at[c] += double(pose.shift_q[std::size_t(c)]) / kFixedOne;
    return geometry.world_from_index(at);
  };
  RigidMotion motion;
  if (!(from.turn == to.turn)) motion.turn = (to.turn * from.turn.inverse()).unit();
  motion.about_lps_mm = centre(from);
  motion.shift_lps_mm = centre(to) - centre(from);
  return motion;
}

bool keeps_bones_apart(const SessionBody& in, const Step& step) {
  return in.material.has_contact && step.limits != Limits::ball && in.body.rigid.list.size() > 1;
}

/// The way of each piece, from `start` to `end`; grabbed ones turn by their `turns`.
PieceWay way_of_pieces(const Geometry& geometry, const std::vector<RigidPiece>& start,
                       const std::vector<RigidPose>& end, const std::vector<PieceMotion>& turns) {
  return [&](std::size_t piece, double part) {
    const auto turn = std::find_if(turns.begin(), turns.end(),
                                   [&](const auto& motion) { return motion.piece == piece; });
    return pose_at(start[piece], end[piece], turn == turns.end() ? nullptr : &turn->motion, part,
                   geometry);
  };
}

/// Finds where pieces meet first on their ways from `start`.
std::optional<BoneStop> first_bone_stop(SessionBody& in, const std::vector<RigidPiece>& start,
                                        const std::vector<RigidPose>& end,
                                        std::vector<PieceMotion> motions, double part) {
  drop_shifts(motions);
  for (PieceMotion& motion : motions) motion.motion = motion.motion.part(part);
  const PieceStop stop =
      in.contact.bones.first_stop(in.body, way_of_pieces(in.body.geometry, start, end, motions));
  if (stop.piece < 0) return std::nullopt;
  return BoneStop{stop.part, start[std::size_t(stop.piece)].name,
                  start[std::size_t(stop.other)].name, stop.voxel, stop.way_mm};
}

/// A drag in contact.
struct ContactDrag : StepTask {
  std::unique_ptr<CutContact> go() const {
    // While a hand leads a bone its tissue waits: it is crushed where the bone comes to rest.
    const bool leads_bone = record.shift_pieces && !pieces.empty();
    std::unique_ptr<CutContact> contact;
    if (!leads_bone || !in.contact.lips_before) contact = contact_of(in, record);
    if (leads_bone && contact) in.contact.lips_before = contact->before();
    if (leads_bone) contact.reset();
    if (!leads_bone) in.contact.lips_before.reset();
    if (contact) {
      move_in_contact(*contact);
    } else {
      move_bones();
    }
    return contact;
  }

  /// Solves a drag beside rigid pieces once, since that takes long; a part of the drag is then that
  /// part of the straight way.
  void move_in_contact(CutContact& contact) const {
    constexpr int kAll = CutContact::kDragParts;
    if (handles.empty()) {
      move_bones();
      record.contact = contact.part(in.fixed_elements(), in.holds, progress);
      follow_shifts(in.body);
    } else if (in.body.rigid.empty()) {
      const auto move = [&](int parts) {
        in.ecm->move(parts == kAll ? handles : in.handles_of(record, pieces, double(parts) / kAll),
                     1, progress);
      };
      record.contact = contact.drag(in.fixed_elements(), in.holds, move, progress);
      record.report = in.ecm->report();
      warn_of_report(record.report, progress);
    } else {
      const auto move = [&] { move_bones(); };
      record.contact = contact.go(in.fixed_elements(), in.holds, move, progress);
      follow_shifts(in.body);
    }
    multiply(record.report, record.contact.parts, kAll);
  }

  /// Solves once. Where pieces meet on the way from where they were to where that takes them, all
  /// goes the part of the way that they leave free.
  void move_bones() const {
    std::optional<StepStart> start;
    if (keeps_bones_apart(in, record)) {
      start.emplace(StepStart{KeptOffsets(in.body), in.holds, in.body.rigid.list});
    }
    drag_freely(*this);
    if (record.ball) return warn_of_report(*record.ball, progress);
    warn_of_report(record.report, progress);
    if (!start) return;
    record.bones = first_bone_stop(in, start->pieces, poses_of(in.body.rigid.list), pieces,
                                   record.report.fraction());
    if (!record.bones) return;
    const double part = record.bones->part;
    if (handles.empty())
      record.bones.reset();  // smallest motions of free pieces: no drag is stopped
    go_to_part(part, *start);
  }

  /// Straight ways are gone back. Pieces that turned would bend on them.
  void go_to_part(double part, const StepStart& start) const {
    auto parts = std::int64_t(std::floor(part * double(kWayParts)));
    bool has_turned = false;
    for (std::size_t n = 0; n < start.pieces.size(); ++n) {
      has_turned = has_turned || !(in.body.rigid.list[n].pose.turn == start.pieces[n].pose.turn);
    }
    if (has_turned) {
      parts = solve_part(parts, start);
    } else {
      KeptOffsets(in.body).restore_part(start.offsets, parts, in.body);
      loosen(in.body, in.holds);
      for (std::size_t n = 0; n < start.pieces.size(); ++n) {
        in.body.rigid.list[n].pose = start.pieces[n].pose;
      }
    }
    follow_shifts(in.body);
    if (!handles.empty()) multiply(record.report, parts, kWayParts);
  }

  /// Solves anew with all pieces at that part of their ways, or at less where limits of tissue
  /// forbid that. Returns the part.
  std::int64_t solve_part(std::int64_t parts, const StepStart& start) const {
    const std::vector<RigidPiece> end = in.body.rigid.list;
    start.offsets.restore(in.body);
    in.holds = start.holds;
    in.body.rigid.list = start.pieces;
    const double done = record.report.fraction();
    const auto handles_at = [&](double so_far) {
      return handles.empty() ? handles : in.handles_of(record, pieces, done * so_far);
    };
    const auto poses_at = [&](double so_far) {
      std::vector<FreePose> poses;
      for (std::size_t n = 0; n < end.size(); ++n) {
        const bool is_grabbed = std::any_of(pieces.begin(), pieces.end(),
                                            [&](const auto& motion) { return motion.piece == n; });
        if (is_grabbed || end[n].pose == start.pieces[n].pose) continue;
        poses.push_back(
            {n, pose_at(start.pieces[n], end[n].pose, nullptr, so_far, in.body.geometry)});
      }
      return poses;
    };
    const FreePoses free(in.body, *in.ecm, progress);
    const auto allows = [&](std::int64_t tried) {
      const double so_far = double(tried) / double(kWayParts);
      return in.ecm->allows(free.with(handles_at(so_far), poses_at(so_far)), progress);
    };
    if (!allows(parts)) {
      std::int64_t stopped = parts;
      parts = 0;
      for (int n = 0; n < kHalvings && stopped - parts > 1; ++n) {
        const std::int64_t tried = (parts + stopped) / 2;
        (allows(tried) ? parts : stopped) = tried;
      }
    }
    const double so_far = double(parts) / double(kWayParts);
    move_with(*this, handles_at(so_far), poses_at(so_far));
    set_poses(in.body, pieces, done * so_far);
    return parts;
  }
};

}  // namespace

double shorten_for_bones(SessionBody& in, std::vector<PieceMotion>& pieces, StepRecord& record,
                         Progress* progress) {
  if (pieces.empty() || !keeps_bones_apart(in, record)) return 1;
  if (record.fem->motion || record.fem->modes) return 1;
  const std::vector<RigidPiece>& start = in.body.rigid.list;
  std::vector<RigidPose> end = poses_of(start);
  for (const PieceMotion& motion : pieces) {
    end[motion.piece] = moved_by(motion.motion, start[motion.piece], in.body.geometry);
  }
  record.bones = first_bone_stop(in, start, end, pieces, 1);
  if (!record.bones) return 1;
  const auto parts = std::int64_t(std::floor(record.bones->part * double(kWayParts)));
  multiply(record.report, parts, kWayParts);
  warn_of_stop(*record.bones, record.report, progress);
  const double part = double(parts) / double(kWayParts);
  for (PieceMotion& piece : pieces) piece.motion = piece.motion.part(part);
  return part;
}

std::function<std::vector<FreePose>(bool)> keeping_apart(const StepTask& task) {
  if (!keeps_bones_apart(task.in, task.record)) return nullptr;
  SessionBody& in = task.in;
  std::vector<PieceMotion> motions = task.pieces;
  drop_shifts(motions);
  std::vector<char> is_free(in.body.rigid.list.size(), 0);
  for (const FreePose& free : in.free_pieces(task.handles)) is_free[free.piece] = 1;
  return [&in, is_free, motions, start = in.body.rigid.list,
          &record = task.record](bool is_last) mutable {
    const std::vector<RigidPose> end = poses_of(in.body.rigid.list);
    const PieceWay way = way_of_pieces(in.body.geometry, start, end, motions);
    std::vector<PieceMeeting> meetings = in.contact.bones.meetings(in.body, way);
    std::stable_sort(meetings.begin(), meetings.end(),
                     [](const auto& a, const auto& b) { return a.part < b.part; });
    std::vector<FreePose> kept;
    auto& told = record.meetings;
    told.erase(std::remove_if(told.begin(), told.end(), [](const auto& m) { return !m.is_kept; }),
               told.end());
    for (const PieceMeeting& meeting : meetings) {
      auto [piece, other] = std::pair(std::size_t(meeting.piece), std::size_t(meeting.other));
      told.push_back({start[piece].name, start[other].name, meeting.voxel, meeting.overlap_voxels});
      if (is_free[piece] == 0) std::swap(piece, other);
      if (is_last || is_free[piece] == 0) continue;
      told.back().is_kept = true;
      is_free[piece] = 0;
      RigidPiece met = start[piece];
      met.pose = way(piece, meeting.part);
      const RigidMotion along =
          between(way(other, meeting.part), end[other], start[other], in.body.geometry);
      kept.push_back({piece, moved_by(along, met, in.body.geometry)});
    }
    return kept;
  };
}

std::unique_ptr<CutContact> contact_of(SessionBody& in, const Step& step) {
  if (!in.material.has_contact || step.limits == Limits::ball || in.body.cuts.empty()) {
    return nullptr;
  }
  const bool is_live = step.shift_pieces || step.drags.empty();
  if (!in.contact.lips || !in.contact.lips->is_current()) {
    in.contact.lips = std::make_shared<CutLips>(in.body, in.body.cuts);
    in.contact.lips_before.reset();
  }
  auto contact = std::make_unique<CutContact>(in.body, in.contact.lips,
                                              is_live ? ContactEffort::live : ContactEffort::full,
                                              in.contact.lips_before);
  return contact->empty() ? nullptr : std::move(contact);
}

std::unique_ptr<CutContact> drag_apart(const StepTask& task) {
  return ContactDrag{task}.go();
}

}  // namespace supple
