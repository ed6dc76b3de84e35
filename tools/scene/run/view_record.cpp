#include "tools/scene/run/view_record.h"

#include <nlohmann/json.hpp>

#include "tools/scene/file/transfer_file.h"
#include "tools/scene/run/reports.h"
#include "tools/scene/run/view_pictures.h"
#include "volumes/base/json.h"
#include "volumes/base/version.h"

namespace supple::tools {

namespace {

nlohmann::ordered_json to_json(const Light& light) {
  Light copy = light;
  return nlohmann::ordered_json::parse(json_text(fields_value(fields(copy))));
}

nlohmann::ordered_json to_json(const MeshChoice& choice) {
  MeshChoice copy = choice;
  auto json = nlohmann::ordered_json::parse(json_text(fields_value(fields(copy))));
  json["path"] = choice.file;
  return json;
}

nlohmann::ordered_json to_json(const ClipChoice& choice) {
  nlohmann::ordered_json json;
  if (choice.voxel_corners) {
    json["box"] = {vector_json(choice.voxel_corners->first),
                   vector_json(choice.voxel_corners->second)};
  }
  for (const HalfSpace& half : choice.clip.region) {
    json["plane"] = {{"point", vector_json(half.point_lps_mm)},
                     {"normal", vector_json(half.normal_lps)}};
  }
  Clip clip = choice.clip;
  json.update(nlohmann::ordered_json::parse(json_text(fields_value(fields(clip)))));
  return json;
}

std::string decoration_json(Decoration decoration) {
  Decoration plain;
  return json_text(fields_value(fields(decoration), fields(plain)));
}

nlohmann::ordered_json to_json(SliceChoice choice) {
  choice.marks = recorded(choice.marks);
  return nlohmann::ordered_json::parse(json_text(fields_value(fields(choice))));
}

/// The settings of a view as it was drawn, but for those of a default view that say nothing.
nlohmann::ordered_json settings_of(SceneView view) {
  SceneView plain;
  view.sampling.step_voxels = view_settings(view).step_voxels;
  plain.image = view.image;  // where the picture lies is not what it shows
  plain.after_step = view.after_step;
  if (view.transfer) view.preset.clear();
  view.marks = recorded(view.marks);
  return nlohmann::ordered_json::parse(json_text(fields_value(fields(view), fields(plain))));
}

}  // namespace

std::string describe_view(const SceneView& view, const nlohmann::ordered_json& more) {
  nlohmann::ordered_json json = {{"program", std::string("supple ") + kVersion}};
  if (view.slice) {
    json.update(to_json(*view.slice));
    json["deformed"] = view.deformed;
    json.update(nlohmann::ordered_json::parse(decoration_json(view.decoration)));
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
    json["camera"] = {{"projection", name_of(camera->projection)},
                      {"position", vector_json(camera->position_lps_mm)},
                      {"target", vector_json(camera->target_lps_mm)},
                      {"up", vector_json(camera->up_lps)},
                      {"fov", camera->vertical_fov_degrees},
                      {"height", camera->height_mm}};
  } else {
    json["camera"] = {{"projection", name_of(view.camera.projection)}, {"view", view.camera.view}};
    if (view.camera.fov_degrees) json["camera"]["fov"] = *view.camera.fov_degrees;
    if (view.camera.height_mm) json["camera"]["height"] = *view.camera.height_mm;
  }
  json.update(more);
  return json.dump();
}

}  // namespace supple::tools
