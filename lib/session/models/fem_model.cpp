// Finite elements as the model of a step.
#include "lib/model/fem_model.h"

#include <algorithm>
#include <utility>

#include "lib/chainmail/cut_contact.h"
#include "lib/fem/voxel/fem.h"
#include "lib/fem/voxel/fem_cost.h"
#include "lib/session/fem_limits.h"
#include "lib/session/fem_task.h"
#include "lib/session/file/fem_keys.h"
#include "lib/session/hand/hand_level.h"
#include "lib/session/hand/live_responses.h"
#include "lib/session/models/drags.h"
#include "lib/session/step_warnings.h"

namespace supple {

namespace {

constexpr double kFineTolerance = 1e-6;

/// The responses of the handle in the directions of the step, before it moves.
std::shared_ptr<const FemResponses> responses_of(const ModelTask& task) {
  std::vector<DragPose> directions;
  for (const HandDirection& direction : task.record.fem->directions) {
    directions.push_back(direction.pose(task.in.body.geometry));
  }
  LiveResponses live(task.in, task.record, std::move(directions));
  live.run(task.progress);
  return live.found();
}

/// Equilibria know no contact: free pieces are kept out of others, and what sides of cuts do is
/// told.
void run_elements(const ModelTask& task) {
  if (task.record.fem->hand_levels > 0) return move_to_hand_level(task);
  SessionBody& in = task.in;
  StepRecord& record = task.record;
  const Vec3d edges_mm = in.body.geometry.spacing_mm();
  record.fem->params = solved_params(*record.fem, !in.state.labels.empty(),
                                     std::min({edges_mm.x, edges_mm.y, edges_mm.z}));
  const std::vector<SlotSet> told = task.told();
  if (record.fem->responses) {
    in.responses = std::exchange(record.fem->responses, {});
  } else if (!record.fem->directions.empty()) {
    in.responses = responses_of(task);
  }
  FemTask work{in.held(),   in.cuts(),  in.state.density, in.state.labels, told,
               task.pieces, task.nodes, in.equilibrium,   in.responses,    {}};
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
  task.start_anew();
}

/// Elements of the fixed boxes, and of rigid pieces that these hold as wholes.
SlotSet fixed_elements(const Step& step, const Body& body) {
  SlotSet fixed;
  for (const ChosenPart& part : step.fix) {
    if (const IndexBox* box = part.box()) fixed.add(elements_of(body, Region(*box), "fix"));
  }
  SlotSet all = fixed;
  for (const RigidPiece& piece : body.rigid.list) {
    Slot slot;
    if (piece.elements->first_common(fixed, slot)) all.add(*piece.elements);
  }
  return all;
}

ModelCost cost_of_elements(const Step& step, const Body& body) {
  const FemStep& fem = *step.fem;
  FemWish wish{fem.params, fem.halvings, !step.rigid.empty() || !body.rigid.empty()};
  if (fem.modes) wish.modes = fem.modes->count;
  if (fem.motion) wish.motion_steps = fem.motion->steps();
  const FemWork work =
      fem_work(count_nodes(body.elements, fixed_elements(step, body)), wish, body.material);
  ModelCost cost{{work.unknowns, "unknowns"}, {work.iterations, "iterations"}};
  cost.bytes = work.bytes;
  cost.units = work.unknown_iterations;
  cost.unit = kFemUnknownCost;
  return cost;
}

void by_fem(Step& step, double tolerance) {
  if (!step.fem) step.fem.emplace();
  step.fem->params.set_accuracy(FemAccuracy::exact);  // from rest, whatever came before
  step.fem->params.tolerance = tolerance;
  step.fem->params.reaction_tolerance = std::max(1e-9, tolerance);
  step.fem->params.max_iterations = 5000;
}

/// Elements of parts of a voxel say how far those of whole voxels are from their limit.
void by_fine_fem(Step& step, double halvings) {
  by_fem(step, kFineTolerance);
  step.fem->halvings = int(halvings);
}

/// The best that elements of several voxels can do; their own error is far larger.
void by_coarse_fem(Step& step, double doublings) {
  constexpr double kCoarseTolerance = 1e-4;
  by_fem(step, kCoarseTolerance);
  step.fem->params.doublings = int(doublings);
}

/// The body of a hand that finite elements follow, once so many levels are there.
void by_hand(Step& step, double levels) {
  by_fem(step, kFineTolerance);
  step.fem->hand_levels = int(levels);
}

/// Solves the same elements, but for their dilatation, by another program.
void by_calculix(Step& step, double solver) {
  by_fem(step, kFineTolerance);
  step.fem->params.solver = EquationSolver(int(solver));
}

/// Solves the same elements by a library for any equations.
void by_dolfinx(Step& step, double tolerance) {
  by_fem(step, tolerance);
  step.fem->params.solver = EquationSolver::dolfinx;
}

}  // namespace

Value fem_settings(const StepRecord& record) {
  const FemReport& report = record.equilibrium.report;
  Value value = settings_value(*record.fem);
  value["iterations"] = report.iterations;
  if (report.error_mm) value["error_left_mm"] = *report.error_mm;
  value["residual_max"] = report.residual_max;
  value["force_balance"] = report.force_balance;
  value["energy_identity"] = report.energy_identity;
  return value;
}

StepModel fem_model() {
  StepModel model;
  model.name = "fem";
  model.title = "finite elements";
  model.menu = "Finite elements, after a drag";
  model.waits_for_hands = true;
  model.moves = [](const Step& step) { return step.fem && !step.fem->tets; };
  model.choose = [](Step& step) { step.fem.emplace(); };
  model.fields = [](Step& step) { return fields(*step.fem); };
  model.option_fields = [](Step& step) { return option_fields(*step.fem); };
  model.read = [](Table& table, const LabelNames& names, Step& step) {
    step.fem = read_fem(table, names);
  };
  model.settings = fem_settings;
  model.cost = cost_of_elements;
  model.shorten = shorten_for_bones;
  model.run = run_elements;
  const std::vector<double> ladder = {1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8};
  const std::vector<double> doublings = {1, 2, 3};
  model.methods = {
      {{"fem", "finite elements", "tolerance", 1e-12, 0.5, false, ladder}, 0, by_fem},
      {{"fem-coarse", "elements of 2, 4, 8 voxels", "doublings", 1, kMostDoublings, true,
        doublings},
       0,
       by_coarse_fem},
      {{"fem-live",
        "finite elements under the hand",
        "levels",
        1,
        kAllLevels,
        true,
        {1, 2, 3, 4, 5, 6}},
       0,
       by_hand},
      {{"fem-fine", "elements of parts of a voxel", "halvings", 1, kMostHalvings, true, {1}},
       0,
       by_fine_fem},
      {{"calculix", "CalculiX: direct, iterative", "solver", 1, 2, true, {2, 1}}, 0, by_calculix},
      {{"dolfinx", "DOLFINx with GAMG", "tolerance", 1e-12, 0.5, false, {1e-4, 1e-6}},
       0,
       by_dolfinx},
  };
  return model;
}

}  // namespace supple
