#include "tools/scene/run/reports.h"

#include "lib/session/deformable_mesh.h"
#include "lib/session/kept_voxels.h"
#include "lib/session/spring_step.h"
#include "lib/session/step_model.h"
#include "lib/session/tet_record.h"

namespace supple::tools {

Value to_value(const BallReport& report, std::int64_t cut_links) {
  return {{"limits", "ball"},
          {"moved", report.moved},
          {"cut_links", cut_links},
          {"moves", report.moves},
          {"capped", report.capped},
          {"links", report.links},
          {"violated", report.violated},
          {"worst_excess_voxels", report.worst_excess_voxels},
          {"max_queue", report.max_queue},
          {"solve_ms", report.milliseconds}};
}

namespace {

Value to_value(const ModelEnergy& energy) {
  return {{"elastic", energy.elastic_j},
          {"kinetic", energy.kinetic_j},
          {"gravity", energy.gravity_j},
          {"total", energy.total_j()}};
}

/// Results of springs that bodies of voxels and meshes share.
template <class Result>
void add_motion(const Result& result, Value& json) {
  if (result.residual_mn) json["residual_mn"] = *result.residual_mn;
  if (!result.motion) return;
  json["substeps"] = result.motion->substeps;
  json["halvings"] = result.motion->halvings;
  json["iterations"] = result.motion->iterations;
  json["contacts"] = result.motion->contacts;
  json["penetration_mm"] = result.motion->penetration_mm;
}

Value to_value(const SpringRecord& record) {
  Value json = {{"steps", record.steps},
                {"nodes", record.nodes},
                {"springs", record.springs},
                {"energy_before_j", to_value(record.before)},
                {"energy_after_j", to_value(record.after)}};
  add_motion(record, json);
  json["links"] = record.links.links;
  json["violated"] = record.links.violated;
  json["worst_excess_voxels"] = record.links.worst_excess_voxels;
  json["springs_ms"] = record.milliseconds;
  return json;
}

Value to_value(const ModesRecord& record) {
  const ModesReport& report = record.report;
  Value modes = Value::List();
  for (const ModeRow& mode : record.modes) {
    modes.push_back({{"frequency_hz", mode.frequency_hz},
                     {"participation_kg_half", mode.participation_kg_half},
                     {"effective_mass_kg", mode.effective_mass_kg},
                     {"residual", mode.residual}});
  }
  return {{"modes", std::move(modes)},
          {"amplitude_mm", record.amplitude_mm},
          {"mass_kg", report.mass_kg},
          {"elements", report.elements},
          {"nodes", report.nodes},
          {"unknowns", report.unknowns},
          {"levels", report.levels},
          {"solutions", report.solutions},
          {"iterations", report.iterations},
          {"late_modes", report.late_modes},
          {"rigid_modes", report.rigid_modes},
          {"islands", report.islands},
          {"loose_islands", report.loose_islands},
          {"loose_elements", report.loose_elements},
          {"largest_residual", report.largest_residual},
          {"orthogonality", report.orthogonality},
          {"bytes", report.bytes},
          {"modes_ms", report.milliseconds}};
}

Value to_value(const MotionRecord& record) {
  const MotionSample& end = record.samples.back();
  double largest_mm = 0, kinetic_mj = 0;
  for (const MotionSample& sample : record.samples) {
    largest_mm = std::max(largest_mm, sample.largest_mm);
    kinetic_mj = std::max(kinetic_mj, sample.energy.kinetic_mj);
  }
  Value json = {{"steps", record.steps},
                {"step_s", record.step_s},
                {"elastic_mj", end.energy.elastic_mj},
                {"kinetic_mj", end.energy.kinetic_mj},
                {"work_mj", end.energy.work_mj},
                {"dissipated_mj", end.energy.dissipated_mj},
                {"largest_kinetic_mj", kinetic_mj},
                {"energy_error", record.energy_error},
                {"largest_mm", largest_mm}};
  for (const Vec3d& u : end.watched_mm) json["watched_mm"].push_back(u);
  return json;
}

Value to_value(const FemRecord& record) {
  const FemReport& report = record.report;
  Value json = {{"elements", report.elements},
                {"nodes", report.nodes},
                {"unknowns", report.unknowns},
                {"levels", report.levels},
                {"iterations", report.iterations},
                {"residual_max", report.residual_max},
                {"residual_rms", report.residual_rms},
                {"largest_force_n", report.largest_force_n},
                {"force_balance", report.force_balance},
                {"energy_identity", report.energy_identity},
                {"energy_mj", report.energy_mj},
                {"reaction_change", report.reaction_change},
                {"islands", report.islands},
                {"loose_islands", report.loose_islands},
                {"loose_elements", report.loose_elements},
                {"largest_rotation_deg", report.largest_rotation_deg},
                {"largest_strain", report.largest_strain},
                {"beyond_linear", report.beyond_linear},
                {"beyond_elements", report.beyond_elements},
                {"smallest_det_f", report.smallest_det_f},
                {"volume_change_ml", report.volume_change_ml},
                {"turned_voxel", Vec3d(report.turned)},
                {"strained_voxel", Vec3d(report.strained)},
                {"bytes", report.bytes},
                {"anchor_force_n", record.anchors.force_n},
                {"anchor_moment_nmm", record.anchors.moment_nmm},
                {"links", record.links.links},
                {"violated", record.links.violated},
                {"worst_excess_voxels", record.links.worst_excess_voxels},
                {"setup_ms", report.setup_ms},
                {"solve_ms", report.solve_ms},
                {"fem_ms", record.milliseconds}};
  if (report.responses) json["responses"] = as_value(*report.responses);
  if (report.error_mm) json["error_left_mm"] = *report.error_mm;
  if (record.motion) {
    for (const char* of_equilibria :
         {"residual_rms", "largest_force_n", "force_balance", "energy_identity", "energy_mj",
          "reaction_change", "volume_change_ml", "setup_ms", "solve_ms"}) {
      json.erase(of_equilibria);
    }
    json["motion"] = to_value(*record.motion);
  }
  for (const SharedHandle& shared : record.shared) {
    json["shared_handles"].push_back({{"grab", shared.name},
                                      {"asked_mm", shared.asked_mm},
                                      {"reached_mm", shared.reached_mm},
                                      {"off_voxels", shared.off_voxels}});
  }
  if (report.newton) {
    json["newton"] = {{"load_steps", report.newton->load_steps},
                      {"rejected_steps", report.newton->rejected_steps},
                      {"corrections", report.newton->newton_iterations},
                      {"shortened", report.newton->shortened_steps},
                      {"smallest_det_f", report.newton->smallest_j}};
  }
  const bool has_fitted = record.fitted_pieces > 0;
  if (has_fitted) json["fitted_pieces"] = record.fitted_pieces;
  if (has_fitted) json["fitted_max_voxels"] = record.fitted_max_voxels;
  for (const StrainGauge& gauge : record.gauges) {
    Value row = {{"label", gauge.label}, {"elements", gauge.elements}};
    for (std::size_t n = 0; n < kFemQuantities.size(); ++n) {
      row[std::string(kFemQuantities[n].second)] = gauge.mean[n];
    }
    json["gauges"].push_back(std::move(row));
  }
  return json;
}

Value to_value(const CellVolumes& volumes) {
  return {{"cells", volumes.cells},
          {"rest_mm3", volumes.rest_mm3},
          {"mm3", volumes.total_mm3},
          {"ratio", volumes.ratio()},
          {"smallest_cell_ratio", volumes.smallest},
          {"largest_cell_ratio", volumes.largest}};
}

Value to_value(const RelaxParams& params, const RelaxReport& report) {
  Value json = {{"method", name_of(params.method)},
                {"passes", report.passes},
                {"converged", report.converged},
                {"ended_by", name_of(report.end)},
                {"energy_before_uj", report.energy_before},
                {"energy_after_uj", report.energy_after},
                {"largest_step_voxels", report.largest_step_voxels},
                {"yielded_links", report.yielded_links},
                {"projected", report.projected_links},
                {"projected_max_voxels", report.projected_max_voxels},
                {"projected_held", report.projected_held},
                {"relax_ms", report.milliseconds}};
  if (report.diagonal_links > 0) {
    json["diagonal_links"] = report.diagonal_links;
    json["diagonal_max_voxels"] = report.diagonal_max_voxels;
  }
  if (report.energy_excess) json["energy_excess_uj"] = *report.energy_excess;
  if (report.volumes_after) {
    json["bulk_modulus_kpa"] = report.bulk_modulus_kpa;
    if (params.poisson) json["poisson"] = true;
    json["volumes_before"] = to_value(*report.volumes_before);
    json["volumes_after"] = to_value(*report.volumes_after);
  }
  return json;
}

Value to_value(const SidesReport& report) {
  return {{"overlapping", report.overlapping},
          {"deepest_voxels", report.deepest_voxels},
          {"max_move_voxels", report.max_move_voxels},
          {"left", report.left},
          {"left_voxels", report.left_voxels},
          {"voxel", {report.voxel.x, report.voxel.y, report.voxel.z}},
          {"crushed", report.is_crushed},
          {"part_of_drag", double(report.parts) / kContactParts}};
}

Value to_value(const BoneStop& stop) {
  return {{"part_of_way", stop.part},
          {"piece", stop.piece},
          {"other", stop.other},
          {"voxel", {stop.voxel.x, stop.voxel.y, stop.voxel.z}},
          {"way_mm", stop.way_mm}};
}

Value to_value(const TightenReport& report) {
  return {{"iterations", report.iterations},
          {"settled", report.settled},
          {"moved", report.moved},
          {"links", report.links},
          {"violated", report.violated},
          {"worst_excess_voxels", report.worst_excess_voxels},
          {"excess_before_voxels", report.excess_before_voxels},
          {"excess_voxels", report.excess_voxels},
          {"projected", report.projected_links},
          {"projected_max_voxels", report.projected_max_voxels},
          {"projected_held", report.projected_held},
          {"tighten_ms", report.milliseconds}};
}

Value to_value(const EcmReport& report, std::int64_t cut_links) {
  return {{"limits", "box"},
          {"fraction", report.fraction()},
          {"fraction_exact", std::to_string(report.fraction_numerator) + "/" +
                                 std::to_string(report.fraction_denominator)},
          {"engine", name_of(report.engine)},
          {"moved", report.moved},
          {"cut_links", cut_links},
          {"projected", report.projected_links},
          {"projected_max_voxels", report.projected_max_voxels},
          {"projected_held", report.projected_held},
          {"visited", report.visited},
          {"max_queue", report.max_queue},
          {"solve_ms", report.milliseconds}};
}

Value to_value(const std::vector<HandleReaction>& reactions) {
  Value json = Value::List();
  for (const HandleReaction& held : reactions) {
    const Vec3d& n = held.reaction.force_n;
    json.push_back({{"step", held.step},
                    {"handle", held.handle},
                    {"grab", held.name},
                    {"force_n", {n.x, n.y, n.z}},
                    {"taut", held.reaction.taut}});
    if (held.moment_nmm) json.back()["moment_nmm"] = *held.moment_nmm;
  }
  return json;
}

}  // namespace

Value to_value(const std::vector<HandlePlace>& places) {
  Value json = Value::List();
  for (const HandlePlace& place : places) {
    json.push_back({{"grab", place.name},
                    {"elements", place.elements},
                    {"voxel", place.centre_index},
                    {"lps_mm", place.centre_lps_mm},
                    {"density", {place.least_density, place.largest_density}},
                    {"labels", Value::List(place.labels.begin(), place.labels.end())}});
  }
  return json;
}

Value to_value(const RigidPieces& pieces) {
  Value list = Value::List();
  for (const RigidPiece& piece : pieces.list) {
    const auto shift = [&](std::size_t c) { return double(piece.pose.shift_q[c]) / kFixedOne; };
    list.push_back({{"name", piece.name},
                    {"elements", piece.elements->size()},
                    {"centre_voxel", piece.centre_index},
                    {"turn_degrees", piece.pose.turn.angle_deg()},
                    {"shift_voxels", {shift(0), shift(1), shift(2)}}});
  }
  return list;
}

namespace {

Value to_value(const MeshRecord& record, const StepRecord& step) {
  const MeshMoveReport& report = record.report;
  Value json = {{"model", step.springs ? "springs" : "ecm"}, {"body", step.body}};
  if (!step.springs) {
    json["fraction"] = report.ecm.fraction();
    json["moved"] = report.ecm.moved;
    json["projected"] = report.ecm.projection.violated_links;
    json["solve_ms"] = report.milliseconds;
    return json;
  }
  Value springs = {{"steps", report.steps},
                   {"springs", report.springs},
                   {"energy_before_j", to_value(report.before)},
                   {"energy_after_j", to_value(report.after)}};
  add_motion(report, springs);
  springs["springs_ms"] = report.milliseconds;
  json["settings"] = settings_value(*step.springs);
  json["springs"] = std::move(springs);
  json["reactions"] = Value::List();
  for (const Reaction& reaction : report.reactions) {
    json["reactions"].push_back({{"force_n", reaction.force_n}});
  }
  for (const Vec3d& force_n : report.collider_forces_n) json["contact_forces_n"].push_back(force_n);
  return json;
}

}  // namespace

Value to_value(const StepRecord& record) {
  if (record.mesh) return to_value(*record.mesh, record);
  if (const StepModel& model = model_of(record); model.report) return model.report(record);
  if (record.springs) {
    Value json = {{"model", "springs"},
                  {"cut_links", record.cut_links},
                  {"settings", settings_value(*record.springs)},
                  {"springs", to_value(record.sprung)}};
    if (record.removed > 0) json["removed"] = record.removed;
    json["reactions"] = to_value(record.reactions);
    for (const Vec3d& force_n : record.sprung.collider_forces_n) {
      json["contact_forces_n"].push_back(force_n);
    }
    return json;
  }
  if (record.fem) {
    Value json = {{"model", model_of(record).name},
                  {"cut_links", record.cut_links},
                  {"settings", settings_value(*record.fem)}};
    if (record.equilibrium.modes) {
      json["modes"] = to_value(*record.equilibrium.modes);
      return json;
    }
    json["fem"] = to_value(record.equilibrium);
    if (record.equilibrium.tets) json["tets"] = to_value(*record.equilibrium.tets);
    if (record.removed > 0) json["removed"] = record.removed;
    if (record.bones) {
      json["fraction"] = record.report.fraction();
      json["bones"] = to_value(*record.bones);
    }
    for (const BoneMeeting& met : record.meetings) {
      json["meetings"].push_back({{"piece", met.piece},
                                  {"other", met.other},
                                  {"voxel", Vec3d(met.voxel)},
                                  {"overlap_voxels", met.overlap_voxels},
                                  {"kept_apart", met.is_kept}});
    }
    if (record.contact.overlapping > 0) json["contact"] = to_value(record.contact);
    json["reactions"] = to_value(record.reactions);
    return json;
  }
  Value json = record.ball ? to_value(*record.ball, record.cut_links)
                           : to_value(record.report, record.cut_links);
  if (record.slid) json["slid"] = *record.slid;
  if (record.removed > 0) json["removed"] = record.removed;
  if (record.bones) json["bones"] = to_value(*record.bones);
  if (record.contact.overlapping > 0) json["contact"] = to_value(record.contact);
  if (record.relax) json["relax"] = to_value(*record.relax, record.relaxed);
  if (record.tightened) {
    json["limits"] = "tighten";
    json["tighten"] = to_value(*record.tightened);
  }
  json["reactions"] = to_value(record.reactions);
  return json;
}

Value to_value(const RenderReport& report) {
  return {{"rays", report.rays},
          {"samples", report.samples},
          {"prepare_ms", report.prepare_ms},
          {"march_ms", report.march_ms},
          {"bytes", report.bytes}};
}

}  // namespace supple::tools
