// Springs as the model of a step.
#include "lib/session/file/spring_keys.h"
#include "lib/session/models/drags.h"
#include "lib/session/spring_step.h"
#include "lib/springs/spring_cost.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

/// Time that springs have to follow their handles and come to rest. Short of a second they still
/// swing, in which case their error says so.
constexpr double kSpringTime_s = 1.0;

void run_springs(const ModelTask& task) {
  StepRecord& record = task.record;
  std::vector<Region> anchors;
  record.sprung = move_by_springs(*record.springs, task.in.held_with_pieces(anchors), task.handles,
                                  task.told(), task.progress);
  if (record.tells_reactions) record.reactions = task.ledger.name(record.sprung.reactions);
  task.start_anew();
}

/// Springs hold rigid pieces, and know no lips.
void check_springs(const Step& step, const SessionBody& in) {
  if (!step.retract.empty()) {
    throw InputError({step.retract.front().place, "retract", "beside springs",
                      "a step of ECM with box limits, or of finite elements"});
  }
  if (in.body.rigid.empty()) return;
  for (const Region& region : in.regions_of(step)) {
    elements_of(in.body, region, "grab").for_each([&](Slot slot) {
      if (in.body.rigid.at(slot) < 0) return;
      throw InputError({"", "grab " + region.name(),
                        "voxel " + voxel_text(voxel_of(in.body.elements, slot)) +
                            " of a rigid piece, which springs hold",
                        "tissue; pieces move in steps without springs"});
    });
  }
}

ModelCost cost_of_springs(const Step& step, const Body& body) {
  const SpringStep& springs = *step.springs;
  const bool is_motion = springs.is_motion();
  const SpringWish wish{is_motion, !is_motion || springs.motion.method == SpringMethod::implicit,
                        !springs.contacts.empty(),
                        is_motion ? springs.motion_steps() : springs.most_steps};
  const SpringWork work =
      spring_work(double(body.elements.active_count()), body.geometry.dims().z == 1, wish);
  ModelCost cost{{work.springs, "springs"}, {work.steps, "steps"}};
  cost.is_exact = is_motion;
  cost.bytes = work.bytes;
  cost.units = work.spring_steps;
  cost.unit = kSpringCost;
  return cost;
}

void to_rest(Step& step, double steps) {
  step.springs = SpringStep();
  step.springs->motion.minimise = true;
  step.springs->most_steps = int(steps);
}
template <SpringMethod integrator>
void in_time(Step& step, double steps) {
  step.springs = SpringStep();
  step.springs->motion.method = integrator;
  step.springs->time_s = kSpringTime_s;
  step.springs->motion.step_s = kSpringTime_s / steps;
}

ModelMethod method(const char* name, const char* title, std::vector<double> ladder,
                   void (*solve)(Step&, double)) {
  return {{name, title, "steps", 1, SpringStep::kMostSteps, true, std::move(ladder)}, 0, solve};
}

}  // namespace

StepModel spring_model() {
  StepModel model;
  model.name = model.title = "springs";
  model.menu = "Springs";
  model.options = "springs-";
  model.moves = [](const Step& step) { return step.springs.has_value(); };
  model.choose = [](Step& step) { step.springs.emplace(); };
  model.fields = [](Step& step) { return fields(*step.springs); };
  model.option_fields = model.fields;
  model.read = [](Table& table, const LabelNames&, Step& step) {
    step.springs = read_spring_step(table);
  };
  model.settings = [](const StepRecord& record) { return settings_value(*record.springs); };
  model.cost = cost_of_springs;
  model.check = check_springs;
  model.run = run_springs;
  model.methods = {
      method("springs", "springs, to rest", {2, 8, 32, 128}, to_rest),
      method("springs-implicit", "implicit Euler, 1 s", {2, 8, 32},
             in_time<SpringMethod::implicit>),
      method("springs-projective", "projective dyn., 1 s", {2, 8, 32},
             in_time<SpringMethod::projective>),
      method("springs-xpbd", "XPBD, 1 s", {8, 32}, in_time<SpringMethod::xpbd>),
      method("springs-symplectic", "symplectic Euler, 1 s", {32},
             in_time<SpringMethod::symplectic>),
  };
  return model;
}

}  // namespace supple
