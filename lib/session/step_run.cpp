#include "lib/session/step_run.h"

#include <algorithm>

#include "lib/relax/relaxation.h"
#include "lib/session/body_changes.h"
#include "lib/session/handle_ledger.h"
#include "lib/session/spring_step.h"
#include "lib/session/step_model.h"
#include "lib/session/step_task.h"
#include "lib/session/step_warnings.h"
#include "volumes/base/relayed_progress.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

/// Says at which pose warnings came, and the same ones once.
class PoseProgress final : public RelayedProgress {
 public:
  PoseProgress(Progress* next, RepeatedLines& lines) : RelayedProgress(next), m_lines(lines) {}

  void warn(const std::string& line) override {
    if (const auto told = m_lines.take(line)) RelayedProgress::warn(*told);
  }
  void note(const std::string& line) override {
    if (const auto told = m_lines.take(line)) RelayedProgress::note(*told);
  }

 private:
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

bool is_relaxed_by_default(const Step& step, const MaterialTable& material) {
  return material.relaxes && !step.no_relax && !step.relax && !step.drags.empty() &&
         !has_own_model(step) && step.limits != Limits::ball;
}

/// A step on its way through its poses.
struct StepRun {
  const StepModel& model;
  SessionBody& in;
  const std::vector<StepRecord>& earlier;
  StepRecord& record;

  void move(Progress* progress) const {
    std::vector<PieceMotion> pieces = in.motions_of(record);
    const std::vector<PieceMotion> asked = pieces;
    const double part = model.shorten ? model.shorten(in, pieces, record, progress) : 1;
    const std::vector<Handle> handles = in.handles_of(record, asked, part);
    HandleLedger ledger = in.walk ? in.walk->ledger : in.ledger;
    ledger.add(int(earlier.size()) + 1, handles, in.body);
    if (in.walk) {
      for (const Handle& handle : handles) {
        if (!handle.is_edge || handle.kind != HandleKind::push) continue;
        let_go(in.holds, elements_of(in.body, handle.region, "grab"));
      }
    }
    static const FemNodes none;
    const FemNodes& nodes = earlier.empty() ? none : earlier.back().equilibrium.nodes;
    model.run({{in, handles, pieces, record, progress}, ledger, nodes});
    in.ledger = std::move(ledger);
  }

  void follow_ways(Progress* progress) const {
    in.walk = StepWalk{in.body, anchored_elements(in.body, in.anchors, in.holds), in.ledger, {}};
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
        move(&told);
      } catch (const InputError& error) {
        throw at_pose(pose, poses, error);
      }
      add(record.report, whole);
      in.walk->earlier = record.drags;
    }
    for (const std::string& line : lines.repeats()) warn(progress, line);
    record.drags = drags;
    record.retract = retract;
    record.tells_reactions = tells_reactions;
    record.report = whole;
  }
};

}  // namespace

void run_step(SessionBody& in, const std::vector<StepRecord>& earlier, StepRecord& record,
              Progress* progress) {
  const bool has_new_elements = !record.remove.empty() || !record.rigid.empty();
  if (!has_new_elements) in.check_elements(record);
  prepare_body(in, record, progress);
  if (has_new_elements) in.check_elements(record);
  const StepModel& model = model_of(record);
  if (model.check) model.check(record, in);
  if (!in.body.rigid.empty() && record.limits != Limits::box) {
    throw InputError({"", "limits", record.limits == Limits::ball ? "ball" : "tighten",
                      "box, in a body with rigid pieces"});
  }
  note_of_links(record, in.body.slacks.links(), progress);
  if (is_relaxed_by_default(record, in.material)) {
    record.relax = tissue_relaxation(in.material.relaxes_by_poisson);
  }
  in.release_and_fix(record);
  if (!record.fix.empty()) {
    SlotSet grabbed;
    for (const Region& region : in.regions_of(record)) {
      grabbed.add(elements_of(in.body, region, "grab"));
    }
    warn_of_missed_pieces(in.body, anchored_elements(in.body, in.anchors, in.holds), grabbed,
                          progress);
  }
  const StepRun run{model, in, earlier, record};
  if (poses_of(record.drags) > 1) {
    run.follow_ways(progress);
  } else {
    run.move(progress);
  }
}

}  // namespace supple
