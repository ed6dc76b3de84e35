// The part of a session that moves the body: drags, turns of pieces, relaxation, tightening.
#include <algorithm>
#include <numeric>

#include "lib/model/quasi_static.h"
#include "lib/session/session.h"
#include "lib/session/step_warnings.h"

namespace supple {

namespace {

/// Turns that anchors stop are shortened to a multiple of this part.
constexpr int kTurnParts = 1024;

bool has_turns(const std::vector<PieceMotion>& pieces) {
  return std::any_of(pieces.begin(), pieces.end(),
                     [](const PieceMotion& piece) { return piece.motion.turns(); });
}

void warn_of_solve(const StepRecord& record, Progress* progress) {
  if (record.ball) return warn_of_report(*record.ball, progress);
  warn_of_report(record.report, progress);
}

/// What the sides did after the relaxation, to what they did before.
void add(const SidesReport& later, SidesReport& report) {
  report.overlapping += later.overlapping;
  report.deepest_voxels = std::max(report.deepest_voxels, later.deepest_voxels);
  report.max_move_voxels = std::max(report.max_move_voxels, later.max_move_voxels);
  report.left = later.left;
  report.left_voxels = later.left_voxels;
}

}  // namespace

void Session::move_quasi_statically(const std::vector<Handle>& handles,
                                    const std::vector<PieceMotion>& pieces, StepRecord& record,
                                    Progress* progress) {
  stage(progress, "solving");
  std::unique_ptr<CutContact> contact = contact_of(record);
  if (contact) {
    solve_in_contact(*contact, handles, pieces, record, progress);
  } else {
    solve(handles, pieces, record, progress);
  }
  warn_of_solve(record, progress);
  if (!handles.empty() || record.release) m_pressure_kpa = 0;
  debug(progress, std::string("solve: ") + (record.ball ? "ball" : name_of(record.report.engine)) +
                      " engine, " + std::to_string(record.report.visited) +
                      " visits, longest queue " + std::to_string(record.report.max_queue) +
                      ", body " + std::to_string(m_body.bytes() >> 20) + " MiB");
  if (record.relax) {
    const int passes = record.relax->passes;
    if (!contact) {
      relax_body(passes, record, progress);
    } else {
      // Fewer passes where all of them press sides together that have no room.
      const auto relax = [&](int parts) {
        relax_body(int(std::int64_t(passes) * parts / CutContact::kDragParts), record, progress);
      };
      contact = contact_of(record);
      add(contact->drag(fixed_elements(), m_holds, relax, progress), record.contact);
      follow_shifts(m_body);
    }
  }
  warn_of_report(record.contact, progress);
  if (record.limits == Limits::tighten) tighten_body(record, progress);
}

void Session::solve(const std::vector<Handle>& handles, const std::vector<PieceMotion>& pieces,
                    StepRecord& record, Progress* progress) {
  if (has_turns(pieces)) {
    return solve_turns(handles, pieces, record, progress);
  }
  if (record.limits != Limits::ball) {
    m_ecm->move(handles, 1, progress);
    follow_shifts(m_body);
    record.report = m_ecm->report();
    return;
  }
  record.ball = drag_ball(m_body, handles, m_anchors, m_holds, BallParams(), progress);
  m_links.fold_free = false;
  record.report.moved = record.ball->moved;
  record.report.visited = record.ball->moves;
  record.report.max_queue = record.ball->max_queue;
  record.report.milliseconds = record.ball->milliseconds;
}

/// None where no cut can close, or nothing is to be kept apart.
std::unique_ptr<CutContact> Session::contact_of(const StepRequest& request) {
  const LinkCuts& cuts = m_body.rigid.empty() ? m_body.cuts : m_state.cuts;
  if (!m_material.has_contact || request.limits == Limits::ball || cuts.empty()) {
    return nullptr;
  }
  auto contact = std::make_unique<CutContact>(m_body, cuts);
  return contact->empty() ? nullptr : std::move(contact);
}

SlotSet Session::fixed_elements() const {
  SlotSet fixed;
  for (const Region& region : m_anchors) fixed.add(elements_of(m_body, region, "fix"));
  return fixed;
}

/// Turning pieces have stopped where anchors stop them; sides that they press together are taken
/// apart as far as there is room.
void Session::solve_in_contact(CutContact& contact, const std::vector<Handle>& handles,
                               const std::vector<PieceMotion>& pieces, StepRecord& record,
                               Progress* progress) {
  if (has_turns(pieces)) {
    solve_turns(handles, pieces, record, progress);
    SlotSet fixed = fixed_elements();
    for (const RigidPiece& piece : m_body.rigid.list) fixed.add(*piece.elements);
    record.contact = contact.part(fixed, m_holds, progress);
    return;
  }
  constexpr int kAll = CutContact::kDragParts;
  const auto move = [&](int parts) {
    m_ecm->move(parts == kAll ? handles : handles_of(record, pieces, double(parts) / kAll), 1,
                progress);
  };
  record.contact = contact.drag(fixed_elements(), m_holds, move, progress);
  follow_shifts(m_body);
  record.report = m_ecm->report();
  if (record.contact.parts == kAll) return;
  record.report.fraction_numerator *= record.contact.parts;
  record.report.fraction_denominator *= kAll;
  const std::int64_t common =
      std::gcd(record.report.fraction_numerator, record.report.fraction_denominator);
  record.report.fraction_numerator /= common;
  record.report.fraction_denominator /= common;
}

bool Session::is_relaxed_by_default(const StepRequest& request) const {
  return m_material.relaxes && !request.no_relax && !request.relax && !request.drags.empty() &&
         !request.springs && request.limits != Limits::ball;
}

void Session::relax_body(int passes, StepRecord& record, Progress* progress) {
  stage(progress, "relaxing");
  m_pressure_kpa = record.relax->bulk_modulus_kpa;
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
  int done = 0, stopped = kTurnParts;
  if (m_ecm->move_whole(handles, progress)) {
    done = kTurnParts;
  } else {
    while (stopped - done > 1) {
      const int part = (done + stopped) / 2;
      const auto shorter = handles_of(record, pieces, double(part) / kTurnParts);
      (m_ecm->allows(shorter, progress) ? done : stopped) = part;
    }
    m_ecm->move_whole(handles_of(record, pieces, double(done) / kTurnParts), progress);
  }
  record.report = m_ecm->report();
  const int common = std::gcd(done, kTurnParts);
  record.report.fraction_numerator = done / common;
  record.report.fraction_denominator = kTurnParts / common;
  set_poses(m_body, pieces, double(done) / kTurnParts);
  follow_shifts(m_body);
}

}  // namespace supple
