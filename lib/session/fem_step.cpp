#include "lib/session/fem_step.h"

#include <algorithm>
#include <chrono>
#include <tuple>

#include "lib/body/kept_offsets.h"
#include "lib/fem/voxel/fem_results.h"
#include "lib/model/fem_model.h"
#include "lib/relax/relaxation.h"
#include "lib/session/fem/element_results.h"
#include "lib/session/fem/fem_modes.h"
#include "lib/session/fem/fem_solid.h"
#include "lib/session/fem/motion_step.h"
#include "lib/session/fem/piece_poses.h"
#include "lib/session/fem/shared_handles.h"
#include "lib/session/fem_task.h"
#include "lib/session/free_poses.h"
#include "lib/session/handles/rigid_drag.h"
#include "lib/session/kept_voxels.h"
#include "lib/session/step_warnings.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/text.h"
#include "volumes/base/value.h"

namespace supple {

namespace {

/// Up to this many times free pieces that would enter others are held, and the rest is solved.
constexpr int kMostSolutions = 5;

void warn_of_result(const FemStep& step, const FemRecord& record, Progress* progress) {
  const FemReport& report = record.report;
  warn_of_shared(record.shared, progress);
  if (report.loose_islands > 0) {
    warn(progress, "finite elements: nothing holds " + with_count(report.loose_islands, "island") +
                       " of " + with_count(report.loose_elements, "element") +
                       ", left where it was at rest");
  }
  if (report.beyond_linear) {
    const auto at = [n = step.halvings](const Vec3i& part) {
      return " at voxel " + voxel_text({part.x >> n, part.y >> n, part.z >> n});
    };
    std::string line = "finite elements: turns of up to " +
                       number_text(report.largest_rotation_deg) + " degrees" + at(report.turned) +
                       " and strains of up to " + number_text(report.largest_strain) +
                       at(report.strained) + " are beyond linear theory (" +
                       number_text(step.params.max_rotation_deg) + " degrees, " +
                       number_text(step.params.max_strain) + ")";
    if (!step.motion) line += " in " + with_count(report.beyond_elements, "element");
    warn(progress, line);
  }
  warn_of_links(record.links, "finite elements",
                step.links_beyond == LinksBeyond::keep
                    ? "later drags keep them, a relaxation projects them"
                    : "a later drag or relaxation projects them",
                progress);
}

/// Modes count from rest and with all that is held at rest; neither loads nor handles act.
void find_modes(const FemStep& step, const FemTask& task, const FemSolid& solid, FemRecord& record,
                Progress* progress) {
  Body& body = task.held.body;
  record.modes =
      find_modes_of_body(*step.modes, step.params, solid.body ? *solid.body : body, solid,
                         anchored_elements(body, task.held.anchors, task.held.holds), progress);
  record.modes->amplitude_mm = step.modes->amplitude_mm.value_or(default_amplitude_mm(body));
  const ModesReport& report = record.modes->report;
  record.report.elements = report.elements;
  record.report.nodes = report.nodes;
  record.report.unknowns = report.unknowns;
  record.report.levels = report.levels;
  record.report.iterations = report.iterations;
  record.report.residual_max = report.largest_residual;
  record.report.bytes = report.bytes;
  if (report.rigid_modes > 0) return;
  record.report.loose_islands = report.loose_islands;
  record.report.loose_elements = report.loose_elements;
}

/// Poses of pieces once the body has moved: where handles took them, where they are kept, or the
/// nearest to where their elements came to.
void settle_pieces(const FemTask& task, const std::vector<FreePose>& kept, FemRecord& record) {
  Body& body = task.held.body;
  set_poses(body, task.pieces, 1);
  for (const FreePose& free : kept) body.rigid.list[free.piece].pose = free.pose;
  std::tie(record.fitted_pieces, record.fitted_max_voxels) = fit_pieces(body);
}

/// Solves, and where free pieces would enter others once more from there, with these held where
/// they meet them. Nothing holds them afterwards. Returns the iterations of all solutions.
int move_apart(const FemStep& step, const FemTask& task, const std::vector<Handle>& handles,
               VoxelFemModel& model, FemRecord& record, Progress* progress) {
  Body& body = task.held.body;
  const KeptOffsets start(body);
  const Holds holds = task.held.holds;
  const std::vector<RigidPiece> pieces = body.rigid.list;
  std::vector<FreePose> kept;
  int iterations = 0;
  for (int round = 0;; ++round) {
    std::vector<Handle> all = handles;
    for (const FreePose& free : kept) {
      all.push_back(handle_at(body, body.rigid.list[free.piece], free.pose));
    }
    model.move(all, 1, progress);
    model.store();
    iterations += model.report().iterations;
    record.shared = shared_handles(model.reaches(), model.grips(), all, body.geometry);
    if (step.keeps_nodes && step.halvings == 0) {
      record.nodes.elements_mm = element_displacements(model.solid().mesh(), body);
    }
    settle_pieces(task, kept, record);
    if (!task.keep_apart) break;
    const std::vector<FreePose> more = task.keep_apart(round == kMostSolutions - 1);
    if (more.empty()) break;
    kept.insert(kept.end(), more.begin(), more.end());
    model.sum_by(nullptr);  // other elements are held for the time being
    model.begin_from(std::make_shared<const NodeStart>(model.displacement_mm().begin(),
                                                       model.displacement_mm().end()));
    start.restore(body);
    task.held.holds = holds;
    body.rigid.list = pieces;
  }
  for (const FreePose& free : kept) {
    task.held.holds.anchored.remove(*body.rigid.list[free.piece].elements);
  }
  return iterations;
}

/// The solid of this body, with what is known of it where earlier steps had the same.
FemResponses responses_for(const FemStep& step, const FemTask& task, std::string& changed,
                           Progress* progress) {
  ResponseKey key = solid_key(step, task);
  if (task.responses) {
    changed = task.responses->voxels->key.change_to(key);
    if (changed.empty()) return *task.responses;
    task.responses.reset();
  }
  return {std::make_shared<KeptVoxels>(std::move(key), step, task, progress), {}};
}

void move_to_equilibrium(const FemStep& step, const FemTask& task,
                         const std::vector<Handle>& handles, FemRecord& record,
                         Progress* progress) {
  std::string changed;
  FemResponses kept = responses_for(step, task, changed, progress);
  const FemSolid& solid = kept.voxels->solid;
  VoxelFemModel model(task.held, kept.voxels->model);
  warn_of_locking(task.held.body, solid, step.params.elements, progress);
  model.set_loads(loads_of(step, task, solid));
  model.set_params(step.params);
  const std::string refused = why_no_sum(step.params);
  const bool may_be_sum = refused.empty();
  model.sum_by(may_be_sum ? &kept.known : nullptr);
  model.tell_of(task.gripped);
  const bool is_picture = step.params.accuracy == FemAccuracy::picture && step.halvings == 0;
  if (is_picture) model.begin_from(task.start);
  const int iterations = move_apart(step, task, handles, model, record, progress);
  if (is_picture) {
    record.equilibrium = std::make_shared<const NodeStart>(model.displacement_mm().begin(),
                                                           model.displacement_mm().end());
  }
  record.report = model.report();
  record.report.iterations = iterations;
  record.reactions = model.reactions(task.gripped);
  record.anchors = model.anchor_reaction();
  const bool is_looked_at = !task.labels.empty() || !step.wanted.empty();
  const SolvedElements solved{model.solid(), model.displacement_mm(), step.params.strain,
                              model.swelling_kpa(), is_looked_at ? model.parts() : ElementParts()};
  record.gauges = gauges_of(solved, task.held.body.elements, task.labels);
  record.values = values_of(solved, task.held.body.elements, step.wanted);
  if (step.keeps_nodes && step.halvings == 0) record.nodes.u_mm = model.displacement_mm();
  if (!may_be_sum && task.responses) record.report.responses = ResponseReport{0, 0, refused};
  if (record.report.responses && record.report.responses->changed.empty()) {
    record.report.responses->changed = changed;
  }
  if (may_be_sum) task.responses = std::make_shared<const FemResponses>(std::move(kept));
}

/// Damping of the elements' material, and that of the step.
RayleighDamping damping_of(const FemStep& step, const FemSolid& solid) {
  RayleighDamping damping;
  damping.mass_per_s = step.motion->mass_damping_per_s;
  damping.stiffness_s = solid.damping_s;
  return damping;
}

void move_in_time(const FemStep& step, const FemTask& task, const FemSolid& solid,
                  const std::vector<Handle>& handles, FemRecord& record, Progress* progress) {
  const MotionStep& motion = *step.motion;
  motion.validate();
  FemMotionParams params{solid.elastic,
                         solid.mass_density,
                         damping_of(step, solid),
                         {},
                         loads_of(step, task, solid),
                         step.params.loose};
  params.elements = step.params.elements;
  params.newmark = {motion.step_length_s(), step.params.residual_limit(),
                    step.params.max_iterations};
  VoxelFemMotion model(task.held, std::move(params), solid.body ? &*solid.body : nullptr, progress);
  model.tell_of(task.gripped);
  model.start_from(task.nodes);
  record.motion = run_motion(motion, model, task.held.body, handles, task.gripped, progress);
  record.shared = shared_handles(model.reaches(), model.grips(), handles, task.held.body.geometry);
  const std::vector<double>& u = model.motion().u_mm();
  FemReport& report = record.report;
  report.elements = model.solid().mesh().element_count();
  report.nodes = model.solid().mesh().node_count();
  for (const std::uint8_t held : model.motion().loads().held) {
    report.unknowns += 3 - __builtin_popcount(held);
  }
  report.levels = model.motion().level_count();
  report.iterations = model.motion().iterations();
  report.residual_max = model.motion().residual_max();
  report.energy_mj = record.motion->samples.back().energy.elastic_mj;
  report.islands = model.loose().islands;
  report.loose_islands = model.held_islands();
  report.loose_elements = report.loose_islands > 0 ? model.loose().loose_elements : 0;
  report.bytes = model.bytes();
  report.largest_rotation_deg = record.motion->largest.rotation_deg;
  report.largest_strain = record.motion->largest.strain;
  report.smallest_det_f = record.motion->largest.smallest_det_f;
  report.turned = record.motion->largest.turned;
  report.strained = record.motion->largest.strained;
  report.beyond_linear = report.largest_rotation_deg > step.params.max_rotation_deg ||
                         report.largest_strain > step.params.max_strain;
  record.reactions = model.reactions(task.gripped);
  record.anchors = model.anchor_reaction();
  const SolvedElements solved{
      model.solid(), u, StrainTheory::linear, model.motion().loads().swelling_kpa, {}};
  record.gauges = gauges_of(solved, task.held.body.elements, task.labels);
  record.values = values_of(solved, task.held.body.elements, step.wanted);
  if (step.keeps_nodes) {
    record.nodes = {u, model.motion().v_mm_s(),
                    element_displacements(model.solid().mesh(), task.held.body)};
  }
}

}  // namespace

void show_frame(std::size_t frame, FemRecord& record, Body& body) {
  take_frame(*record.motion, frame, body);
  std::tie(record.fitted_pieces, record.fitted_max_voxels) = fit_pieces(body);
  record.links = check_links(body);
  body.links_known_valid = record.links.violated == 0;
  body.beyond.reset();
}

void show_mode(int number, FemRecord& record, Body& body) {
  take_mode_shape(*record.modes, number, body);
  std::tie(record.fitted_pieces, record.fitted_max_voxels) = fit_pieces(body);
  record.links = check_links(body);
  body.links_known_valid = record.links.violated == 0;
  body.beyond.reset();
}

FemRecord move_by_fem(const FemStep& step, const FemTask& task, const std::vector<Handle>& handles,
                      Progress* progress) {
  const auto begin = std::chrono::steady_clock::now();
  stage(progress, "finite elements");
  Body& body = task.held.body;
  FemRecord record;
  if (const auto problem = contradiction(step)) throw InputError(*problem);
  std::optional<FemSolid> solid;
  if (step.modes || step.motion) {
    solid = fem_solid(task.held.body, task.cuts, step.rigid_young_kpa, step.rigid_poisson);
    warn_of_locking(body, *solid, step.params.elements, progress);
  }
  if (step.modes) {
    if (!handles.empty()) {
      throw InputError({"", "modes", "handles", "anchors alone, which stay at rest"});
    }
    find_modes(step, task, *solid, record, progress);
    show_mode(step.modes->shape, record, body);
    record.milliseconds = ms_since(begin);
    warn_of_result(step, record, progress);
    return record;
  }
  const std::vector<RigidPiece> before = body.rigid.list;
  if (step.motion) {
    move_in_time(step, task, *solid, handles, record, progress);
    settle_pieces(task, {}, record);
    if (task.keep_apart) task.keep_apart(true);
  } else {
    move_to_equilibrium(step, task, handles, record, progress);
  }
  if (!body.rigid.empty()) warn_of_moved_pieces(body, before, task.pieces, progress);
  record.links = check_links(body);
  body.links_known_valid = record.links.violated == 0;
  body.beyond.reset();
  if (step.links_beyond == LinksBeyond::keep) {
    stage(progress, "keeping links beyond limits");
    keep_beyond(body, anchored_elements(body, task.held.anchors, task.held.holds), {}, progress);
  }
  record.milliseconds = ms_since(begin);
  warn_of_result(step, record, progress);
  return record;
}

}  // namespace supple
