// Drags by Enhanced ChainMail, with turns of rigid pieces, or within ball limits.
#include <algorithm>
#include <numeric>

#include "lib/chainmail/ball_limits.h"
#include "lib/session/models/drags.h"
#include "lib/session/rigid_request.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

/// Turns that anchors stop are shortened to a multiple of this part.
constexpr int kTurnParts = 1024;
/// Drags that turns of free pieces lengthen are shortened to a multiple of this part.
constexpr int kDragParts = 64;

/// The largest part of `all` that a bisection finds possible; `done` is.
template <class IsPossible>
int largest_part(int done, int all, IsPossible&& is_possible) {
  while (all - done > 1) {
    const int part = (done + all) / 2;
    (is_possible(part) ? done : all) = part;
  }
  return done;
}

bool has_turns(const std::vector<PieceMotion>& pieces) {
  return std::any_of(pieces.begin(), pieces.end(),
                     [](const PieceMotion& piece) { return piece.motion.turns(); });
}

/// A drag as if nothing met.
struct FreeDrag : StepTask {
  void go() const {
    if (record.limits != Limits::ball) {
      if (has_turns(pieces)) {
        solve_turns();
      } else if (!record.shift_pieces || !shift_pieces()) {
        move_free_pieces_too();
      }
      if (!record.shift_pieces) turn_shifted_pieces();
      return;
    }
    record.ball = drag_ball(in.body, handles, in.anchors, in.holds, BallParams(), progress);
    in.links.fold_free = false;
    record.report.moved = record.ball->moved;
    record.report.visited = record.ball->moves;
    record.report.max_queue = record.ball->max_queue;
    record.report.milliseconds = record.ball->milliseconds;
  }

  /// Pieces keep their shape on the way: they turn by a part of their angle, the largest multiple
  /// of 1/1024 that a bisection finds.
  void solve_turns() const {
    int done = kTurnParts;
    std::vector<Handle> allowed = handles;
    bool is_moved = in.ecm->move_unless_pieces_shift(handles, true, progress);
    if (!is_whole(in.ecm->report())) {
      done = largest_part(0, kTurnParts, [&](int part) {
        return in.ecm->allows(in.handles_of(record, pieces, double(part) / kTurnParts), progress);
      });
      allowed = in.handles_of(record, pieces, double(done) / kTurnParts);
      is_moved = in.ecm->move_unless_pieces_shift(allowed, true, progress);
    }
    record.report = in.ecm->report();
    if (!is_moved) {
      FreePoses search(in.body, *in.ecm, progress);
      std::vector<FreePose> poses = search.shifted(record.report);
      search.shrink(allowed, poses);
      move_with(*this, allowed, poses);
    }
    const int common = std::gcd(done, kTurnParts);
    record.report.fraction_numerator = done / common;
    record.report.fraction_denominator = kTurnParts / common;
    set_poses(in.body, pieces, double(done) / kTurnParts);
    follow_shifts(in.body);
  }

  /// Free pieces that shifts alone would move take their smallest motions instead. Where shifts
  /// make the drag shorter, or impossible, the largest multiple of 1/64 that such motions allow is
  /// tried.
  void move_free_pieces_too() const {
    FreePoses search(in.body, *in.ecm, progress);
    std::vector<FreePose> poses;
    try {
      const bool is_moved = in.ecm->move_unless_pieces_shift(handles, false, progress);
      record.report = in.ecm->report();
      if (is_moved) return follow_shifts(in.body);
      poses = search.shifted(record.report);
    } catch (const InputError&) {
      poses = in.free_pieces(handles);
      if (poses.empty() || !search.find(handles, poses)) throw;
      record.report = EcmReport();
      record.report.engine = in.ecm->report().engine;
    }
    EcmReport& report = record.report;
    if (!is_whole(report)) {
      const int shifted = int(report.fraction() * kDragParts);
      std::vector<FreePose> found;
      const int part = largest_part(shifted, kDragParts, [&](int tried) {
        std::vector<FreePose> further = poses;
        if (!search.find(shortened(handles, tried, kDragParts), further)) return false;
        found = std::move(further);
        return true;
      });
      if (!found.empty()) {
        poses = std::move(found);
        const int common = std::gcd(part, kDragParts);
        report.fraction_numerator = part / common;
        report.fraction_denominator = kDragParts / common;
      }
    }
    const std::vector<Handle> allowed =
        shortened(handles, report.fraction_numerator, report.fraction_denominator);
    search.shrink(allowed, poses);
    move_with(*this, allowed, poses);
  }

  /// The whole drag, or the part that anchors allow where that shifts no piece. Otherwise false,
  /// and nothing has moved: smallest motions may get further.
  bool shift_pieces() const {
    try {
      if (!in.ecm->move_whole_or_unshifted(handles, progress)) return false;
    } catch (const InputError&) {
      return false;  // a turn may still do
    }
    record.report = in.ecm->report();
    for (const PieceShift& shift : record.report.shifted) {
      RigidPiece& piece = in.body.rigid.list[shift.piece];
      if (!piece.shifted_from) piece.shifted_from = piece.pose;
    }
    follow_shifts(in.body);
    return true;
  }

  /// Pieces that are held by now stay where they are.
  void turn_shifted_pieces() const {
    if (!in.has_shifted_pieces()) return;
    std::vector<FreePose> poses = in.free_pieces({});
    poses.erase(std::remove_if(poses.begin(), poses.end(),
                               [&](const FreePose& free) {
                                 return !in.body.rigid.list[free.piece].shifted_from;
                               }),
                poses.end());
    const std::int64_t moved = record.report.moved;
    if (!poses.empty()) {
      FreePoses(in.body, *in.ecm, progress).shrink({}, poses);
      move_with(*this, {}, poses);
    }
    record.report.moved = std::max(moved, record.report.moved);
    in.forget_shifts();
  }
};

}  // namespace

void drag_freely(const StepTask& task) {
  FreeDrag{task}.go();
}

void move_with(const StepTask& task, const std::vector<Handle>& handles,
               const std::vector<FreePose>& poses) {
  SessionBody& in = task.in;
  EcmReport& report = task.record.report;
  const EcmReport told = report;
  const FreePoses free(in.body, *in.ecm, task.progress);
  in.ecm->move_whole(free.with(handles, poses), task.progress);
  report = in.ecm->report();
  report.fraction_numerator = told.fraction_numerator;
  report.fraction_denominator = told.fraction_denominator;
  for (const FreePose& moved : poses) {
    RigidPiece& piece = in.body.rigid.list[moved.piece];
    piece.pose = moved.pose;
    piece.shifted_from.reset();
    in.holds.anchored.remove(*piece.elements);
  }
  follow_shifts(in.body);
}

}  // namespace supple
