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

}  // namespace

void Session::move_quasi_statically(const std::vector<Handle>& handles,
                                    const std::vector<PieceMotion>& pieces, StepRecord& record,
                                    Progress* progress) {
  stage(progress, "solving");
  solve(handles, pieces, record, progress);
  if (!handles.empty() || record.release) m_pressure_kpa = 0;
  debug(progress, std::string("solve: ") + (record.ball ? "ball" : name_of(record.report.engine)) +
                      " engine, " + std::to_string(record.report.visited) +
                      " visits, longest queue " + std::to_string(record.report.max_queue) +
                      ", body " + std::to_string(m_body.bytes() >> 20) + " MiB");
  if (record.relax) relax_body(record, progress);
  if (record.limits == Limits::tighten) tighten_body(record, progress);
}

void Session::solve(const std::vector<Handle>& handles, const std::vector<PieceMotion>& pieces,
                    StepRecord& record, Progress* progress) {
  const bool has_turns = std::any_of(pieces.begin(), pieces.end(),
                                     [](const PieceMotion& piece) { return piece.motion.turns(); });
  if (has_turns) {
    solve_turns(handles, pieces, record, progress);
    return warn_of_report(record.report, progress);
  }
  if (record.limits != Limits::ball) {
    m_ecm->move(handles, 1, progress);
    follow_shifts(m_body);
    record.report = m_ecm->report();
    warn_of_report(record.report, progress);
    return;
  }
  record.ball = drag_ball(m_body, handles, m_anchors, m_holds, BallParams(), progress);
  m_links.fold_free = false;
  record.report.moved = record.ball->moved;
  record.report.visited = record.ball->moves;
  record.report.max_queue = record.ball->max_queue;
  record.report.milliseconds = record.ball->milliseconds;
  warn_of_report(*record.ball, progress);
}

bool Session::is_relaxed_by_default(const StepRequest& request) const {
  return m_material.relaxes && !request.no_relax && !request.relax && !request.drags.empty() &&
         !request.springs && request.limits != Limits::ball;
}

void Session::relax_body(StepRecord& record, Progress* progress) {
  stage(progress, "relaxing");
  m_pressure_kpa = record.relax->bulk_modulus_kpa;
  std::vector<Region> anchors;
  RelaxModel model(held_with_pieces(anchors), *record.relax);
  run_model(model, record.relax->passes, progress);
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
