// Steps: what comes before anything moves, then the drags, from pose to pose where they have ways.
#include "lib/session/session_walk.h"

#include <algorithm>

#include "lib/model/quasi_static.h"
#include "lib/session/handles/drag_handles.h"
#include "lib/session/step_warnings.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

/// Says at which pose warnings came, and the same ones once.
class PoseProgress final : public Progress {
 public:
  PoseProgress(Progress* next, RepeatedLines& lines) : m_next(next), m_lines(lines) {}

  void stage(std::string_view name) override { supple::stage(m_next, name); }
  void update(double fraction) override {
    if (m_next != nullptr) m_next->update(fraction);
  }
  bool cancelled() const override { return m_next != nullptr && m_next->cancelled(); }
  void warn(const std::string& line) override {
    if (const auto told = m_lines.take(line)) supple::warn(m_next, *told);
  }
  void note(const std::string& line) override {
    if (const auto told = m_lines.take(line)) supple::note(m_next, *told);
  }
  void debug(const std::string& line) override { supple::debug(m_next, line); }

 private:
  Progress* m_next;
  RepeatedLines& m_lines;
};

std::size_t poses_of(const std::vector<Drag>& drags) {
  std::size_t poses = 1;
  for (const Drag& drag : drags) poses = std::max(poses, drag.way.size() + 1);
  return poses;
}

std::vector<Drag> drags_at(std::vector<Drag> drags, std::size_t pose) {
  for (Drag& drag : drags) {
    if (pose < drag.way.size()) {
      drag.by_mm = drag.way[pose].by_mm;
      drag.motion = drag.way[pose].motion;
    }
    drag.way.clear();
  }
  return drags;
}

/// Adds the report of a pose to that of all poses so far.
void add(const EcmReport& report, EcmReport& whole) {
  if (report.fraction() < whole.fraction()) {
    whole.fraction_numerator = report.fraction_numerator;
    whole.fraction_denominator = report.fraction_denominator;
  }
  whole.moved = std::max(whole.moved, report.moved);
  whole.projected_links += report.projected_links;
  whole.projected_max_voxels = std::max(whole.projected_max_voxels, report.projected_max_voxels);
  whole.projected_held += report.projected_held;
  whole.engine = report.engine;
  whole.visited += report.visited;
  whole.max_queue = std::max(whole.max_queue, report.max_queue);
  whole.milliseconds += report.milliseconds;
}

InputError at_pose(std::size_t pose, std::size_t poses, const InputError& error) {
  const Problem& problem = error.problem();
  return InputError({problem.file,
                     problem.field + " at pose " + std::to_string(pose + 1) + " of " +
                         std::to_string(poses) + " of the path",
                     problem.found, problem.expected});
}

/// Bounds of elements that are not in the set.
void let_go(Holds& holds, const SlotSet& set) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::vector<Bound>* bounds : {&holds.at_least[c], &holds.at_most[c]}) {
      bounds->erase(std::remove_if(bounds->begin(), bounds->end(),
                                   [&](const Bound& bound) { return set.contains(bound.slot); }),
                    bounds->end());
    }
  }
}

}  // namespace

void Session::run_step(StepRecord& record, Progress* progress) {
  const bool has_new_elements = !record.remove.empty() || !record.rigid.empty();
  if (!has_new_elements) check(record);
  prepare_body(record, progress);
  if (has_new_elements) check(record);
  check_model_of_pieces(record);
  note_of_links(record, m_body.slacks.links(), progress);
  if (is_relaxed_by_default(record)) {
    record.relax = tissue_relaxation(m_material.relaxes_by_poisson);
  }
  release_and_fix(record);
  if (!record.fix.empty()) {
    SlotSet grabbed;
    for (const Region& region : regions_of(record)) {
      grabbed.add(elements_of(m_body, region, "grab"));
    }
    warn_of_missed_pieces(m_body, anchored_elements(m_body, m_anchors, m_holds), grabbed, progress);
  }
  if (poses_of(record.drags) > 1) {
    follow_ways(record, progress);
  } else {
    move(record, progress);
  }
}

std::vector<PieceMotion> Session::motions_of(const Step& request) const {
  const bool goes_on = m_walk && !m_walk->earlier.empty();
  const Body& start = goes_on ? m_walk->start : m_body;
  std::vector<PieceMotion> pieces = motions_of_pieces(start, request.drags, regions_of(request));
  if (!goes_on) return pieces;
  for (PieceMotion& piece : pieces) piece = continued(piece, start, m_body);
  return pieces;
}

void Session::move(StepRecord& record, Progress* progress) {
  std::vector<PieceMotion> pieces = motions_of(record);
  const std::vector<PieceMotion> asked = pieces;
  const double part = record.fem ? shorten_for_bones(pieces, record, progress) : 1;
  const std::vector<Handle> handles = handles_of(record, asked, part);
  HandleLedger ledger = m_walk ? m_walk->ledger : m_ledger;
  ledger.add(int(m_records.size()) + 1, handles, m_body);
  if (m_walk) {
    for (const Handle& handle : handles) {
      if (!handle.is_edge || handle.kind != HandleKind::push) continue;
      let_go(m_holds, elements_of(m_body, handle.region, "grab"));
    }
  }
  if (record.springs) {
    const std::vector<SlotSet> told =
        record.tells_reactions ? ledger.elements() : std::vector<SlotSet>();
    std::vector<Region> anchors;
    record.sprung =
        move_by_springs(*record.springs, held_with_pieces(anchors), handles, told, progress);
    if (record.tells_reactions) record.reactions = ledger.name(record.sprung.reactions);
    m_relaxed_by = {};
    forget_shifts();
  } else if (record.fem) {
    move_by_elements(handles, pieces, ledger, record, progress);
    m_relaxed_by = {};
    forget_shifts();
  } else {
    move_quasi_statically(handles, pieces, record, progress);
    if (record.tells_reactions) {
      stage(progress, "forces on handles");
      record.reactions = ledger.name(
          quasi_static_reactions(held(), ledger.elements(), moduli_of(m_body, m_relaxed_by)));
    }
  }
  m_ledger = std::move(ledger);
}

void Session::show_frame(int frame) {
  if (m_keeps_undo || m_records.empty() || !m_records.back().equilibrium.motion) {
    throw std::logic_error("no motion to show");
  }
  supple::show_frame(std::size_t(frame), m_records.back().equilibrium, m_body);
  m_pose.reset();
}

void Session::show_mode(int number) {
  if (m_keeps_undo || m_records.empty() || !m_records.back().equilibrium.modes) {
    throw std::logic_error("no modes to show");
  }
  StepRecord& last = m_records.back();
  supple::show_mode(number, last.equilibrium, m_body);
  last.fem->modes->shape = number;
  m_pose.reset();
}

void Session::follow_ways(StepRecord& record, Progress* progress) {
  m_walk = std::make_unique<Walk>(
      Walk{m_body, anchored_elements(m_body, m_anchors, m_holds), m_ledger, {}});
  const std::vector<Drag> drags = record.drags;
  const std::vector<Retraction> retract = record.retract;
  const bool tells_reactions = record.tells_reactions;
  const std::size_t poses = poses_of(drags);
  // Lips open by the same part at each pose: `by` goes on from where they are.
  for (Retraction& patch : record.retract) patch.by_mm /= double(poses);
  RepeatedLines lines("pose");
  EcmReport whole;
  for (std::size_t pose = 0; pose < poses; ++pose) {
    poll(progress);
    lines.enter(int(pose) + 1);
    PoseProgress told(progress, lines);
    record.drags = drags_at(drags, pose);
    record.tells_reactions = tells_reactions && pose + 1 == poses;
    record.bones.reset();
    try {
      move(record, &told);
    } catch (const InputError& error) {
      throw at_pose(pose, poses, error);
    }
    add(record.report, whole);
    m_walk->earlier = record.drags;
  }
  for (const std::string& line : lines.repeats()) warn(progress, line);
  record.drags = drags;
  record.retract = retract;
  record.tells_reactions = tells_reactions;
  record.report = whole;
}

}  // namespace supple
