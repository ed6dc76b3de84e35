// The part of a session that moves the body: drags, turns of pieces, relaxation, tightening.
#include <algorithm>
#include <numeric>

#include "lib/chainmail/cut_contact.h"
#include "lib/model/quasi_static.h"
#include "lib/relax/relaxation.h"
#include "lib/session/free_poses.h"
#include "lib/session/session.h"
#include "lib/session/step_warnings.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

/// Turns that anchors stop are shortened to a multiple of this part.
constexpr int kTurnParts = 1024;
/// Drags that turns of free pieces lengthen are shortened to a multiple of this part.
constexpr int kDragParts = 64;

bool is_whole(const EcmReport& report) {
  return report.fraction_numerator == report.fraction_denominator;
}

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

/// Adds the report of the sides after the relaxation to the one before.
void add(const SidesReport& later, SidesReport& report) {
  report.overlapping += later.overlapping;
  report.deepest_voxels = std::max(report.deepest_voxels, later.deepest_voxels);
  report.max_move_voxels = std::max(report.max_move_voxels, later.max_move_voxels);
  report.left = later.left;
  report.deepened = later.deepened;
  report.is_crushed = report.is_crushed && later.left > 0;
  if (later.left > 0) report.voxel = later.voxel;
  report.left_voxels = later.left_voxels;
}

bool slides(const Drag& drag) {
  return drag.slides && drag.motion.is_shift();
}

/// Hands on all but lines for the user.
class Silent final : public Progress {
 public:
  explicit Silent(Progress* next) : m_next(next) {}

  void stage(std::string_view name) override { supple::stage(m_next, name); }
  void update(double fraction) override {
    if (m_next != nullptr) m_next->update(fraction);
  }
  bool cancelled() const override { return m_next != nullptr && m_next->cancelled(); }

 private:
  Progress* m_next;
};

}  // namespace

Vec3d way_done(const StepRecord& record, const Vec3d& by_mm) {
  return record.slid ? by_mm * *record.slid : by_mm * record.report.fraction();
}

/// Solves with bones and the sides of cuts kept apart. Returns their contact, or null.
std::unique_ptr<CutContact> Session::solve_apart(const std::vector<Handle>& handles,
                                                 const std::vector<PieceMotion>& pieces,
                                                 StepRecord& record, Progress* progress) {
  // While a hand leads a bone its tissue waits: it is crushed where the bone comes to rest.
  const bool leads_bone = record.shift_pieces && !pieces.empty();
  std::unique_ptr<CutContact> contact;
  if (!leads_bone || !m_lips_before) contact = contact_of(record);
  if (leads_bone && contact) m_lips_before = contact->before();
  if (leads_bone) contact.reset();
  if (!leads_bone) m_lips_before.reset();
  if (contact) {
    solve_in_contact(*contact, handles, pieces, record, progress);
  } else {
    solve(handles, pieces, record, progress);
  }
  return contact;
}

/// The rest of a way that something has stopped, along one axis after the other: links limit each
/// on its own.
void Session::slide_on(StepRecord& record, Progress* progress) {
  const double done = record.report.fraction();
  Vec3d slid(done);
  Silent silent(progress);
  for (int c = 0; c < 3; ++c) {
    StepRecord rest;
    rest.limits = record.limits;
    rest.shift_pieces = record.shift_pieces;
    bool has_way = false;
    for (Drag drag : record.drags) {
      const double way_mm = slides(drag) ? drag.by_mm[c] * (1 - done) : 0;
      drag.by_mm = Vec3d(0);
      drag.by_mm[c] = way_mm;
      drag.motion = {};
      has_way = has_way || way_mm != 0;
      rest.drags.push_back(std::move(drag));
    }
    slid[c] = 1;
    if (!has_way) continue;
    const std::vector<PieceMotion> pieces = motions_of(rest);
    solve_apart(handles_of(rest, pieces, 1), pieces, rest, &silent);
    if (!is_whole(rest.report)) slid[c] = done + (1 - done) * rest.report.fraction();
    record.report.moved = std::max(record.report.moved, rest.report.moved);
    add(rest.contact, record.contact);
  }
  record.slid = slid;
}

void Session::move_quasi_statically(const std::vector<Handle>& handles,
                                    const std::vector<PieceMotion>& pieces, StepRecord& record,
                                    Progress* progress) {
  stage(progress, "solving");
  std::unique_ptr<CutContact> contact = solve_apart(handles, pieces, record, progress);
  const bool has_sliding = std::any_of(record.drags.begin(), record.drags.end(), slides);
  if (has_sliding && !m_walk && !record.ball && !is_whole(record.report))
    slide_on(record, progress);
  if (!handles.empty() || record.release) m_relaxed_by = {};
  debug(progress, std::string("solve: ") + (record.ball ? "ball" : name_of(record.report.engine)) +
                      " engine, " + std::to_string(record.report.visited) +
                      " visits, longest queue " + std::to_string(record.report.max_queue) +
                      ", body " + std::to_string(m_body.bytes() >> 20) + " MiB");
  if (record.relax) {
    const int passes = record.relax->passes;
    // Sides that what is held keeps pressed together are not taken apart on the way either.
    if (!contact || record.contact.left > 0) {
      relax_body(passes, record, progress);
    } else {
      contact = contact_of(record);
      const auto relax = [&] { relax_body(passes, record, progress); };
      add(contact->go(fixed_elements(), m_holds, relax, progress), record.contact);
      follow_shifts(m_body);
    }
  }
  if (record.bones) warn_of_stop(*record.bones, record.report, progress);
  warn_of_report(record.contact, progress);
  if (record.limits == Limits::tighten) tighten_body(record, progress);
}

/// Equilibria know no contact: free pieces are kept out of others, and what sides of cuts do is
/// told.
void Session::move_by_elements(const std::vector<Handle>& handles,
                               const std::vector<PieceMotion>& pieces, const HandleLedger& ledger,
                               StepRecord& record, Progress* progress) {
  const std::vector<SlotSet> told =
      record.tells_reactions ? ledger.elements() : std::vector<SlotSet>();
  static const FemNodes none;
  const FemNodes& nodes = m_records.empty() ? none : m_records.back().equilibrium.nodes;
  FemTask task{held(),        cuts(), m_state.density, m_state.labels, told, pieces, nodes,
               m_equilibrium, {}};
  std::unique_ptr<CutContact> contact;
  if (!record.fem->modes) {
    contact = contact_of(record);
    if (keeps_bones_apart(record)) task.keep_apart = keeping_apart(handles, pieces, record);
  }
  record.equilibrium = move_by_fem(*record.fem, task, handles, progress);
  if (record.equilibrium.equilibrium) m_equilibrium = std::move(record.equilibrium.equilibrium);
  if (record.tells_reactions) record.reactions = ledger.name(record.equilibrium.reactions);
  m_lips_before.reset();
  if (contact) record.contact = contact->found();
  warn_of_meetings(record.meetings, progress);
  warn_of_sides(record.contact, progress);
}

void Session::solve_freely(const std::vector<Handle>& handles,
                           const std::vector<PieceMotion>& pieces, StepRecord& record,
                           Progress* progress) {
  if (record.limits != Limits::ball) {
    if (has_turns(pieces)) {
      solve_turns(handles, pieces, record, progress);
    } else if (!record.shift_pieces || !shift_pieces(handles, record, progress)) {
      move_free_pieces_too(handles, record, progress);
    }
    if (!record.shift_pieces) turn_shifted_pieces(record, progress);
    return;
  }
  record.ball = drag_ball(m_body, handles, m_anchors, m_holds, BallParams(), progress);
  m_links.fold_free = false;
  record.report.moved = record.ball->moved;
  record.report.visited = record.ball->moves;
  record.report.max_queue = record.ball->max_queue;
  record.report.milliseconds = record.ball->milliseconds;
}

bool Session::is_relaxed_by_default(const Step& request) const {
  return m_material.relaxes && !request.no_relax && !request.relax && !request.drags.empty() &&
         !request.springs && !request.fem && request.limits != Limits::ball;
}

void Session::relax_body(int passes, StepRecord& record, Progress* progress) {
  stage(progress, "relaxing");
  m_relaxed_by = *record.relax;
  std::vector<Region> anchors;
  RelaxModel model(held_with_pieces(anchors), *record.relax);
  run_model(model, passes, progress);
  record.relaxed = model.report();
  const LinkCheck check =
      record.relax->method == RelaxMethod::plain ? check_links(m_body) : LinkCheck();
  warn_of_report(record.relaxed, check, progress);
}

void Session::tighten_body(StepRecord& record, Progress* progress) {
  stage(progress, "tightening");
  record.tightened = tighten(m_body, m_anchors, m_holds, TightenParams(), progress);
  warn_of_report(*record.tightened, progress);
}

/// Pieces keep their shape on the way: they turn by a part of their angle, the largest multiple of
/// 1/1024 that a bisection finds.
void Session::solve_turns(const std::vector<Handle>& handles,
                          const std::vector<PieceMotion>& pieces, StepRecord& record,
                          Progress* progress) {
  int done = kTurnParts;
  std::vector<Handle> allowed = handles;
  bool is_moved = m_ecm->move_unless_pieces_shift(handles, true, progress);
  if (!is_whole(m_ecm->report())) {
    done = largest_part(0, kTurnParts, [&](int part) {
      return m_ecm->allows(handles_of(record, pieces, double(part) / kTurnParts), progress);
    });
    allowed = handles_of(record, pieces, double(done) / kTurnParts);
    is_moved = m_ecm->move_unless_pieces_shift(allowed, true, progress);
  }
  record.report = m_ecm->report();
  if (!is_moved) {
    FreePoses search(m_body, *m_ecm, progress);
    std::vector<FreePose> poses = search.shifted(record.report);
    search.shrink(allowed, poses);
    move_with(allowed, poses, record, progress);
  }
  const int common = std::gcd(done, kTurnParts);
  record.report.fraction_numerator = done / common;
  record.report.fraction_denominator = kTurnParts / common;
  set_poses(m_body, pieces, double(done) / kTurnParts);
  follow_shifts(m_body);
}

/// Free pieces that shifts alone would move take their smallest motions instead. Where shifts make
/// the drag shorter, or impossible, the largest multiple of 1/64 that such motions allow is tried.
void Session::move_free_pieces_too(const std::vector<Handle>& handles, StepRecord& record,
                                   Progress* progress) {
  FreePoses search(m_body, *m_ecm, progress);
  std::vector<FreePose> poses;
  try {
    const bool is_moved = m_ecm->move_unless_pieces_shift(handles, false, progress);
    record.report = m_ecm->report();
    if (is_moved) return follow_shifts(m_body);
    poses = search.shifted(record.report);
  } catch (const InputError&) {
    poses = free_pieces(handles);
    if (poses.empty() || !search.find(handles, poses)) throw;
    record.report = EcmReport();
    record.report.engine = m_ecm->report().engine;
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
  move_with(allowed, poses, record, progress);
}

/// The whole drag, or the part that anchors allow where that shifts no piece. Otherwise false, and
/// nothing has moved: smallest motions may get further.
bool Session::shift_pieces(const std::vector<Handle>& handles, StepRecord& record,
                           Progress* progress) {
  try {
    if (!m_ecm->move_whole_or_unshifted(handles, progress)) return false;
  } catch (const InputError&) {
    return false;  // a turn may still do
  }
  record.report = m_ecm->report();
  for (const PieceShift& shift : record.report.shifted) {
    RigidPiece& piece = m_body.rigid.list[shift.piece];
    if (!piece.shifted_from) piece.shifted_from = piece.pose;
  }
  follow_shifts(m_body);
  return true;
}

/// Pieces that are held by now stay where they are.
void Session::turn_shifted_pieces(StepRecord& record, Progress* progress) {
  if (!has_shifted_pieces()) return;
  std::vector<FreePose> poses = free_pieces({});
  poses.erase(std::remove_if(poses.begin(), poses.end(),
                             [&](const FreePose& free) {
                               return !m_body.rigid.list[free.piece].shifted_from;
                             }),
              poses.end());
  const std::int64_t moved = record.report.moved;
  if (!poses.empty()) {
    FreePoses(m_body, *m_ecm, progress).shrink({}, poses);
    move_with({}, poses, record, progress);
  }
  record.report.moved = std::max(moved, record.report.moved);
  forget_shifts();
}

bool Session::has_shifted_pieces() const {
  const std::vector<RigidPiece>& pieces = m_body.rigid.list;
  return std::any_of(pieces.begin(), pieces.end(),
                     [](const RigidPiece& piece) { return piece.shifted_from.has_value(); });
}

void Session::forget_shifts() {
  for (RigidPiece& piece : m_body.rigid.list) piece.shifted_from.reset();
}

/// Pieces that nothing holds, where they are.
std::vector<FreePose> Session::free_pieces(const std::vector<Handle>& handles) const {
  SlotSet held = anchored_elements(m_body, m_anchors, m_holds);
  for (const Handle& handle : handles) held.add(elements_of(m_body, handle.region, "grab"));
  std::vector<FreePose> poses;
  for (std::size_t n = 0; n < m_body.rigid.list.size(); ++n) {
    const RigidPiece& piece = m_body.rigid.list[n];
    Slot slot;
    if (!piece.elements->first_common(held, slot)) poses.push_back({n, piece.pose});
  }
  return poses;
}

/// The drag of which the record tells, with free pieces at these poses, which nothing holds then.
void Session::move_with(const std::vector<Handle>& handles, const std::vector<FreePose>& poses,
                        StepRecord& record, Progress* progress) {
  const EcmReport told = record.report;
  const FreePoses free(m_body, *m_ecm, progress);
  m_ecm->move_whole(free.with(handles, poses), progress);
  record.report = m_ecm->report();
  record.report.fraction_numerator = told.fraction_numerator;
  record.report.fraction_denominator = told.fraction_denominator;
  for (const FreePose& moved : poses) {
    RigidPiece& piece = m_body.rigid.list[moved.piece];
    piece.pose = moved.pose;
    piece.shifted_from.reset();
    m_holds.anchored.remove(*piece.elements);
  }
  follow_shifts(m_body);
}

}  // namespace supple
