#include "tools/outputs/outputs.h"

#include <algorithm>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "raycast/drawings/lattice.h"
#include "tools/scene/transfer_file.h"
#include "volumes/base/version.h"
#include "volumes/field/displacement.h"
#include "volumes/field/inversion/forward_offsets.h"
#include "volumes/grid/volume.h"

namespace supple::tools {

Camera resolve_camera(const CameraChoice& choice, const Geometry& geometry, double aspect) {
  if (choice.camera) return *choice.camera;
  Camera camera = default_camera(geometry, aspect, choice.view, choice.projection,
                                 choice.fov_degrees.value_or(Camera().vertical_fov_degrees));
  camera.height_mm = choice.height_mm.value_or(camera.height_mm);
  return camera;
}

namespace {

Image draw_body_lattice(const PosedVolume& subject, const SceneView& view) {
  const Displacement displacement =
      on_elements(subject.geometry, subject.elements, subject.displacement);
  const Camera camera = camera_of(subject, view);
  LatticeStyle style;
  style.width = view.size[0];
  style.height = view.size[1];
  style.grey_lo = subject.grey_lo;
  style.grey_hi = subject.grey_hi;
  return draw_lattice(subject.geometry, subject.density, displacement, camera, style);
}

}  // namespace

Camera camera_of(const PosedVolume& subject, const SceneView& view) {
  const double aspect = double(view.size[0]) / view.size[1];
  const bool is_flat = view.lattice && subject.geometry.dims().z == 1;
  const CameraChoice& choice = view.camera;
  const bool is_default =
      !choice.camera && choice.view == "anterior" && !choice.fov_degrees && !choice.height_mm;
  if (is_flat && is_default) {
    const Displacement displacement =
        on_elements(subject.geometry, subject.elements, subject.displacement);
    return lattice_camera(subject.geometry, displacement, aspect);
  }
  return resolve_camera(view.camera, subject.geometry, aspect);
}

RenderSettings view_settings(const SceneView& view) {
  RenderSettings settings;
  settings.width = view.size[0];
  settings.height = view.size[1];
  view.sampling.apply_to(settings);
  settings.lighting = view.lighting;
  settings.clip_surfaces = view.clip_meshes;
  settings.auxiliary = !view.picture.aux.empty() || picture_kind(view.image) == PictureKind::exr;
  return settings;
}

void rethrow_at(const std::string& place, const InputError& error) {
  const Problem& problem = error.problem();
  if (!problem.file.empty() || place.empty()) throw error;
  throw InputError({place, problem.field, problem.found, problem.expected});
}

void check_inverse(const SceneView& view, const std::vector<OffsetFunction>& functions) {
  if (view.inverse || !view.deformed || functions.empty()) return;
  throw InputError({view.place, "inverse", "sampling paths, which follow offsets",
                    "inverse = true, or a deformed state alone"});
}

void check_view(const SceneView& view) {
  try {
    if (!view.preset.empty()) preset(view.preset);
    view_settings(view).validate();
    check_picture_options(view.picture, view.image, view.place);
    check_inverse(view, view.path);
  } catch (const InputError& error) {
    rethrow_at(view.place, error);
  }
}

SceneView effective_view(const SceneView& view, const Geometry& geometry, double min_density) {
  SceneView effective = view;
  effective.lattice = view.lattice || geometry.dims().z == 1;
  if (view.preset.empty() && !view.transfer)
    effective.preset = are_hounsfield_units(min_density) ? "CT-Bone" : "MR-Default";
  return effective;
}

namespace {

/// A warp file says where tissue came from, not where a point of it goes.
const Displacement* displacement_for_meshes(const PosedVolume& subject, const SceneView& view) {
  for (const MeshChoice& mesh : view.meshes) {
    if (mesh.deform && subject.offsets != nullptr && subject.displacement == nullptr) {
      throw InputError({mesh.place, "deform", "offsets of a warp file",
                        "a state or the steps of a scene, which know where tissue goes"});
    }
  }
  return subject.displacement;
}

}  // namespace

bool reads_displacement(const SceneView& view) {
  const auto deforms = [](const MeshChoice& mesh) { return mesh.deform; };
  return !view.inverse || view.lattice || view.picture.sequence > 0 || !view.path.empty() ||
         std::any_of(view.meshes.begin(), view.meshes.end(), deforms);
}

std::unique_ptr<Renderer> make_renderer(const PosedVolume& subject, const SceneView& view) {
  auto renderer = std::make_unique<Renderer>(subject.geometry, subject.density, subject.air_rings);
  pose(*renderer, subject, view);
  return renderer;
}

void pose(Renderer& renderer, const PosedVolume& subject, const SceneView& view) {
  if (subject.offsets == nullptr && subject.displacement != nullptr) {
    renderer.set_pointwise_offsets(
        std::make_shared<const ForwardOffsets>(*subject.displacement, &subject.elements));
  } else {
    renderer.set_offsets(subject.offsets,
                         view.half_offsets ? OffsetResolution::half : OffsetResolution::full);
  }
  if (!view.meshes.empty()) {
    renderer.set_surfaces(surfaces_of(view.meshes, displacement_for_meshes(subject, view)));
  }
}

FloatImage draw(const PosedVolume& subject, const Renderer* renderer, const SceneView& view,
                RenderReport* report, Console& console) {
  if (view.slice) {
    return to_float(draw_slices(
        {subject.geometry, subject.density, subject.outlined, subject.offsets}, *view.slice));
  }
  if (view.lattice && !view.clips.empty()) {
    throw InputError({view.place, "clip", "a lattice to draw", "a volume of several slices"});
  }
  if (view.lattice && !view.meshes.empty()) {
    throw InputError({view.place, "mesh", "a lattice to draw", "a volume of several slices"});
  }
  if (view.lattice) return to_float(draw_body_lattice(subject, view));
  RenderSettings settings = view_settings(view);
  settings.clips = resolve_clips(view.clips, subject.geometry);
  const TransferFunction function = view.transfer ? *view.transfer : preset(view.preset);
  return renderer->render_float(camera_of(subject, view), function, settings, report, &console);
}

namespace {

nlohmann::ordered_json to_json(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

nlohmann::ordered_json to_json(const ClipChoice& choice) {
  nlohmann::ordered_json json;
  if (choice.voxel_corners) {
    json["box"] = {to_json(choice.voxel_corners->first), to_json(choice.voxel_corners->second)};
  }
  for (const HalfSpace& half : choice.clip.region) {
    json["plane"] = {{"point", to_json(half.point_lps_mm)}, {"normal", to_json(half.normal_lps)}};
  }
  Clip clip = choice.clip;
  json.update(nlohmann::ordered_json::parse(fields_json(fields(clip))));
  return json;
}

nlohmann::ordered_json to_json(SliceChoice choice) {
  return nlohmann::ordered_json::parse(fields_json(fields(choice)));
}

/// The settings of a view as it was drawn, but for those of a default view that say nothing.
nlohmann::ordered_json settings_of(SceneView view) {
  SceneView plain;
  view.sampling.step_voxels = view_settings(view).step_voxels;
  plain.image = view.image;  // where the picture lies is not what it shows
  plain.after_step = view.after_step;
  if (view.transfer) view.preset.clear();
  return nlohmann::ordered_json::parse(fields_json(fields(view), fields(plain)));
}

}  // namespace

std::string describe_view(const SceneView& view, const nlohmann::ordered_json& more) {
  nlohmann::ordered_json json = {{"program", std::string("supple ") + kVersion}};
  if (view.slice) {
    json.update(to_json(*view.slice));
    json["deformed"] = view.deformed;
    json.update(more);
    return json.dump();
  }
  if (view.transfer) json["transfer"] = to_toml(*view.transfer);
  json["size"] = view.size;
  json["deformed"] = view.deformed;
  json["lattice"] = view.lattice;
  json.update(settings_of(view));
  for (const Light& light : view.lighting.lights) json["light"].push_back(to_json(light));
  for (const MeshChoice& mesh : view.meshes) json["mesh"].push_back(to_json(mesh));
  for (const OffsetFunction& function : view.path) {
    json["path"].push_back(nlohmann::ordered_json::parse(function.json));
  }
  for (const ClipChoice& clip : view.clips) json["clip"].push_back(to_json(clip));
  const auto name_of = [](Projection projection) {
    return projection == Projection::perspective ? "perspective" : "orthographic";
  };
  if (const auto& camera = view.camera.camera) {
    json["camera"] = {
        {"projection", name_of(camera->projection)}, {"position", to_json(camera->position_lps_mm)},
        {"target", to_json(camera->target_lps_mm)},  {"up", to_json(camera->up_lps)},
        {"fov", camera->vertical_fov_degrees},       {"height", camera->height_mm}};
  } else {
    json["camera"] = {{"projection", name_of(view.camera.projection)}, {"view", view.camera.view}};
    if (view.camera.fov_degrees) json["camera"]["fov"] = *view.camera.fov_degrees;
    if (view.camera.height_mm) json["camera"]["height"] = *view.camera.height_mm;
  }
  json.update(more);
  return json.dump();
}

nlohmann::ordered_json to_json(const InversionCertificate& certificate) {
  return nlohmann::ordered_json::parse(certificate_json(certificate));
}

nlohmann::ordered_json to_json(const BallReport& report, std::int64_t cut_links) {
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

nlohmann::ordered_json to_json(const ModelEnergy& energy) {
  return {{"elastic", energy.elastic_j},
          {"kinetic", energy.kinetic_j},
          {"gravity", energy.gravity_j},
          {"total", energy.total_j()}};
}

nlohmann::ordered_json to_json(const SpringRecord& record) {
  nlohmann::ordered_json json = {{"steps", record.steps},
                                 {"nodes", record.nodes},
                                 {"springs", record.springs},
                                 {"energy_before_j", to_json(record.before)},
                                 {"energy_after_j", to_json(record.after)}};
  if (record.residual_mn) json["residual_mn"] = *record.residual_mn;
  if (record.motion) {
    json["substeps"] = record.motion->substeps;
    json["halvings"] = record.motion->halvings;
    json["iterations"] = record.motion->iterations;
    json["contacts"] = record.motion->contacts;
    json["penetration_mm"] = record.motion->penetration_mm;
  }
  json["links"] = record.links.links;
  json["violated"] = record.links.violated;
  json["worst_excess_voxels"] = record.links.worst_excess_voxels;
  json["springs_ms"] = record.milliseconds;
  return json;
}

nlohmann::ordered_json to_json(const CellVolumes& volumes) {
  return {{"cells", volumes.cells},
          {"rest_mm3", volumes.rest_mm3},
          {"mm3", volumes.total_mm3},
          {"ratio", volumes.ratio()},
          {"smallest_cell_ratio", volumes.smallest},
          {"largest_cell_ratio", volumes.largest}};
}

nlohmann::ordered_json to_json(const RelaxParams& params, const RelaxReport& report) {
  nlohmann::ordered_json json = {{"method", name_of(params.method)},
                                 {"passes", report.passes},
                                 {"converged", report.converged},
                                 {"energy_before_uj", report.energy_before},
                                 {"energy_after_uj", report.energy_after},
                                 {"largest_step_voxels", report.largest_step_voxels},
                                 {"yielded_links", report.yielded_links},
                                 {"projected", report.projected_links},
                                 {"projected_max_voxels", report.projected_max_voxels},
                                 {"projected_held", report.projected_held},
                                 {"relax_ms", report.milliseconds}};
  if (report.energy_excess) json["energy_excess_uj"] = *report.energy_excess;
  if (report.volumes_after) {
    json["bulk_modulus_kpa"] = params.bulk_modulus_kpa;
    json["volumes_before"] = to_json(*report.volumes_before);
    json["volumes_after"] = to_json(*report.volumes_after);
  }
  return json;
}

nlohmann::ordered_json to_json(const TightenReport& report) {
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

nlohmann::ordered_json to_json(const EcmReport& report, std::int64_t cut_links) {
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

}  // namespace

namespace {

nlohmann::ordered_json to_json(const std::vector<HandleReaction>& reactions) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const HandleReaction& held : reactions) {
    const Vec3d& n = held.reaction.force_n;
    json.push_back({{"step", held.step},
                    {"handle", held.handle},
                    {"grab", held.name},
                    {"force_n", {n.x, n.y, n.z}},
                    {"taut", held.reaction.taut}});
  }
  return json;
}

}  // namespace

void print_places(const std::vector<HandlePlace>& places) {
  for (const HandlePlace& place : places) {
    const Vec3d& voxel = place.centre_index;
    const Vec3d& lps = place.centre_lps_mm;
    std::printf("grab %-10s %lld %s voxel %.4g,%.4g,%.4g, LPS %.4g, %.4g, %.4g mm, density %.4g",
                place.name.c_str(), static_cast<long long>(place.elements),
                place.elements == 1 ? "element at" : "elements around", voxel.x, voxel.y, voxel.z,
                lps.x, lps.y, lps.z, double(place.least_density));
    if (place.largest_density > place.least_density) {
      std::printf(" to %.4g", double(place.largest_density));
    }
    std::string labels;
    for (const std::int32_t label : place.labels) {
      labels += (labels.empty() ? ", label " : ", ") +
                (label == 0 ? std::string("none") : std::to_string(label));
    }
    std::printf("%s\n", labels.c_str());
  }
}

nlohmann::ordered_json to_json(const std::vector<HandlePlace>& places) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const HandlePlace& place : places) {
    json.push_back({{"grab", place.name},
                    {"elements", place.elements},
                    {"voxel", to_json(place.centre_index)},
                    {"lps_mm", to_json(place.centre_lps_mm)},
                    {"density", {place.least_density, place.largest_density}},
                    {"labels", place.labels}});
  }
  return json;
}

void print_reactions(const std::vector<HandleReaction>& reactions) {
  for (const HandleReaction& held : reactions) {
    const Vec3d& n = held.reaction.force_n;
    const auto& taut = held.reaction.taut;
    std::printf("pull at %-15s %.4g, %.4g, %.4g N (LPS)%s\n", held.name.c_str(), n.x, n.y, n.z,
                taut[0] || taut[1] || taut[2] ? ", or more: links at their limits join it to "
                                                "something else that is held"
                                              : "");
  }
}

nlohmann::ordered_json to_json(const StepRecord& record) {
  if (record.springs) {
    nlohmann::ordered_json json = {
        {"model", "springs"},
        {"cut_links", record.cut_links},
        {"settings", nlohmann::ordered_json::parse(settings_json(*record.springs))},
        {"springs", to_json(record.sprung)}};
    json["reactions"] = to_json(record.reactions);
    return json;
  }
  nlohmann::ordered_json json = record.ball ? to_json(*record.ball, record.cut_links)
                                            : to_json(record.report, record.cut_links);
  if (record.relax) json["relax"] = to_json(*record.relax, record.relaxed);
  if (record.tightened) {
    json["limits"] = "tighten";
    json["tighten"] = to_json(*record.tightened);
  }
  json["reactions"] = to_json(record.reactions);
  return json;
}

nlohmann::ordered_json to_json(const RenderReport& report) {
  return {{"rays", report.rays},
          {"samples", report.samples},
          {"prepare_ms", report.prepare_ms},
          {"march_ms", report.march_ms},
          {"bytes", report.bytes}};
}

void print_dense_report(const std::string& path, const Geometry& grid, std::int64_t lost_voxels,
                        const InversionCertificate& certificate) {
  const Vec3i& dims = grid.dims();
  const nlohmann::ordered_json json = {{"output", path},
                                       {"dims", {dims.x, dims.y, dims.z}},
                                       {"lost_voxels", lost_voxels},
                                       {"certificate", to_json(certificate)}};
  std::printf("%s\n", json.dump(2).c_str());
}

}  // namespace supple::tools
