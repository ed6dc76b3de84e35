// Enhanced ChainMail, or ball limits, with relaxation and tightening as the model of a step.
#include <algorithm>

#include "lib/chainmail/cut_contact.h"
#include "lib/chainmail/ecm.h"
#include "lib/chainmail/tighten.h"
#include "lib/model/quasi_static.h"
#include "lib/model/relax_model.h"
#include "lib/relax/relaxation.h"
#include "lib/session/fem_task.h"
#include "lib/session/models/drags.h"
#include "lib/session/rigid_request.h"
#include "lib/session/spring_step.h"
#include "lib/session/step_warnings.h"
#include "volumes/base/error.h"
#include "volumes/base/relayed_progress.h"

namespace supple {

namespace {

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

/// A drag, its relaxation, and its tightening.
struct ChainMailMove : ModelTask {
  void go() const {
    stage(progress, "solving");
    std::unique_ptr<CutContact> contact = drag_apart(*this);
    const bool has_sliding = std::any_of(record.drags.begin(), record.drags.end(), slides);
    if (has_sliding && !in.walk && !record.ball && !is_whole(record.report)) slide_on();
    if (!handles.empty() || record.release) in.relaxed_by = {};
    debug(progress, std::string("solve: ") +
                        (record.ball ? "ball" : name_of(record.report.engine)) + " engine, " +
                        std::to_string(record.report.visited) + " visits, longest queue " +
                        std::to_string(record.report.max_queue) + ", body " +
                        std::to_string(in.body.bytes() >> 20) + " MiB");
    if (record.relax) {
      // Sides that what is held keeps pressed together are not taken apart on the way either.
      if (!contact || record.contact.left > 0) {
        relax_body();
      } else {
        contact = contact_of(in, record);
        const auto relax = [&] { relax_body(); };
        add(contact->go(in.fixed_elements(), in.holds, relax, progress), record.contact);
        follow_shifts(in.body);
      }
    }
    if (record.bones) warn_of_stop(*record.bones, record.report, progress);
    warn_of_report(record.contact, progress);
    if (record.limits == Limits::tighten) tighten_body();
  }

  /// The rest of a way that something has stopped, along one axis after the other: links limit each
  /// on its own.
  void slide_on() const {
    const double done = record.report.fraction();
    Vec3d slid(done);
    UntoldProgress silent(progress);
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
      const std::vector<PieceMotion> grabbed = in.motions_of(rest);
      drag_apart({in, in.handles_of(rest, grabbed, 1), grabbed, rest, &silent});
      if (!is_whole(rest.report)) slid[c] = done + (1 - done) * rest.report.fraction();
      record.report.moved = std::max(record.report.moved, rest.report.moved);
      add(rest.contact, record.contact);
    }
    record.slid = slid;
  }

  void relax_body() const {
    stage(progress, "relaxing");
    in.relaxed_by = *record.relax;
    std::vector<Region> anchors;
    RelaxModel model(in.held_with_pieces(anchors), *record.relax);
    run_model(model, record.relax->passes, progress);
    record.relaxed = model.report();
    const LinkCheck check =
        record.relax->method == RelaxMethod::plain ? check_links(in.body) : LinkCheck();
    warn_of_report(record.relaxed, check, progress);
  }

  void tighten_body() const {
    stage(progress, "tightening");
    record.tightened = tighten(in.body, in.anchors, in.holds, TightenParams(), progress);
    warn_of_report(*record.tightened, progress);
  }
};

void run(const ModelTask& task) {
  ChainMailMove{task}.go();
  if (!task.record.tells_reactions) return;
  stage(task.progress, "forces on handles");
  task.record.reactions = task.ledger.name(quasi_static_reactions(
      task.in.held(), task.ledger.elements(), moduli_of(task.in.body, task.in.relaxed_by)));
}

void check(const Step& step, const SessionBody&) {
  if (step.retract.empty() || step.limits != Limits::ball) return;
  throw InputError({step.retract.front().place, "retract", "beside limits = \"ball\"",
                    "a step of ECM with box limits, or of finite elements"});
}

void by_box(Step&, double) {}
void by_ball(Step& step, double) {
  step.limits = Limits::ball;
}
void by_relaxation(Step& step, double passes) {
  step.no_relax = false;
  step.relax = RelaxParams();
  step.relax->passes = int(passes);
}
void by_elastic_relaxation(Step& step, double passes) {
  by_relaxation(step, passes);
  step.relax->poisson = true;
}

ModelMethod relaxation(const char* name, const char* title, int links,
                       void (*solve)(Step&, double)) {
  return {{name, title, "passes", 1, kMaxPasses, true, {1, 4, 16, 64, 256, 1024}}, links, solve};
}

}  // namespace

Vec3d way_done(const StepRecord& record, const Vec3d& by_mm) {
  return record.slid ? by_mm * *record.slid : by_mm * record.report.fraction();
}

StepModel chainmail_model() {
  StepModel model;
  model.name = "ecm";
  model.title = "Enhanced ChainMail";
  model.menu = "ChainMail (ECM)";
  model.knows_pushes = true;
  model.check = check;
  model.run = run;
  model.methods = {
      {{"ecm", "ECM", "links", 6, 26, true, {6, 18, 26}, true}, kKnobLinks, by_box},
      {{"ecm-ball", "ECM, ball limits", "links", 6, 6, true, {6}, true}, kKnobLinks, by_ball},
      relaxation("relax-6", "relaxed, 6 links", 6, by_relaxation),
      relaxation("relax-18", "relaxed, 18 links", 18, by_relaxation),
      relaxation("relax-26", "relaxed, 26 links", 26, by_relaxation),
      relaxation("relax-poisson", "relaxed, volume by \u03bd", 6, by_elastic_relaxation),
  };
  return model;
}

}  // namespace supple
