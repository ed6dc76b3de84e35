// Models of a step: Enhanced ChainMail with relaxation and tightening, springs, finite elements.
#include <algorithm>

#include "lib/chainmail/cut_contact.h"
#include "lib/model/quasi_static.h"
#include "lib/relax/relaxation.h"
#include "lib/session/step_task.h"
#include "lib/session/step_warnings.h"

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

}  // namespace

Vec3d way_done(const StepRecord& record, const Vec3d& by_mm) {
  return record.slid ? by_mm * *record.slid : by_mm * record.report.fraction();
}

void move_by_chainmail(const ModelTask& task) {
  ChainMailMove{task}.go();
  if (!task.record.tells_reactions) return;
  stage(task.progress, "forces on handles");
  task.record.reactions = task.ledger.name(quasi_static_reactions(
      task.in.held(), task.ledger.elements(), moduli_of(task.in.body, task.in.relaxed_by)));
}

namespace {

/// The elements of handles whose reactions are wanted.
std::vector<SlotSet> told_elements(const ModelTask& task) {
  return task.record.tells_reactions ? task.ledger.elements() : std::vector<SlotSet>();
}

}  // namespace

void move_by_springs(const ModelTask& task) {
  StepRecord& record = task.record;
  std::vector<Region> anchors;
  record.sprung = move_by_springs(*record.springs, task.in.held_with_pieces(anchors), task.handles,
                                  told_elements(task), task.progress);
  if (record.tells_reactions) record.reactions = task.ledger.name(record.sprung.reactions);
  task.in.relaxed_by = {};
  task.in.forget_shifts();
}

/// Equilibria know no contact: free pieces are kept out of others, and what sides of cuts do is
/// told.
void move_by_elements(const ModelTask& task) {
  SessionBody& in = task.in;
  StepRecord& record = task.record;
  const std::vector<SlotSet> told = told_elements(task);
  FemTask work{in.held(),       in.cuts(),      in.state.density,
               in.state.labels, told,           task.pieces,
               task.nodes,      in.equilibrium, {}};
  std::unique_ptr<CutContact> contact;
  if (!record.fem->modes) {
    contact = contact_of(in, record);
    work.keep_apart = keeping_apart(task);
  }
  record.equilibrium = move_by_fem(*record.fem, work, task.handles, task.progress);
  if (record.equilibrium.equilibrium) in.equilibrium = std::move(record.equilibrium.equilibrium);
  if (record.tells_reactions) record.reactions = task.ledger.name(record.equilibrium.reactions);
  in.contact.lips_before.reset();
  if (contact) record.contact = contact->found();
  warn_of_meetings(record.meetings, task.progress);
  warn_of_sides(record.contact, task.progress);
  in.relaxed_by = {};
  in.forget_shifts();
}

}  // namespace supple
