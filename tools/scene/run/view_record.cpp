#include "tools/scene/run/view_record.h"

#include "raycast/scene/transfer_file.h"
#include "tools/scene/run/reports.h"
#include "tools/scene/run/view_pictures.h"
#include "volumes/base/json.h"
#include "volumes/base/version.h"

namespace supple::tools {

namespace {

Value to_value(const Light& light) {
  Light copy = light;
  return fields_value(fields(copy));
}

Value to_value(const MeshChoice& choice) {
  MeshChoice copy = choice;
  auto json = fields_value(fields(copy));
  json["path"] = choice.file;
  return json;
}

Value to_value(const ClipChoice& choice) {
  Value json = Value::Entries();
  if (choice.voxel_corners) {
    json["box"] = {choice.voxel_corners->first, choice.voxel_corners->second};
  }
  for (const HalfSpace& half : choice.clip.region) {
    json["plane"] = {{"point", half.point_lps_mm}, {"normal", half.normal_lps}};
  }
  Clip clip = choice.clip;
  json.update(fields_value(fields(clip)));
  return json;
}

Value to_value(Decoration decoration) {
  Decoration plain;
  return fields_value(fields(decoration), fields(plain));
}

Value to_value(SliceChoice choice) {
  choice.marks = recorded(choice.marks);
  return fields_value(fields(choice));
}

/// The settings of a view as it was drawn, but for those of a default view that say nothing.
Value settings_of(SceneView view) {
  SceneView plain;
  view.sampling.step_voxels = view_settings(view).step_voxels;
  plain.image = view.image;  // where the picture lies is not what it shows
  plain.after_step = view.after_step;
  if (view.transfer) view.preset.clear();
  view.marks = recorded(view.marks);
  return fields_value(fields(view), fields(plain));
}

}  // namespace

std::string describe_view(const SceneView& view, const Value& more) {
  Value json = {{"program", std::string("supple ") + kVersion}};
  if (view.slice) {
    json.update(to_value(*view.slice));
    json["deformed"] = view.deformed;
    json.update(to_value(view.decoration));
    json.update(more);
    return json_text(json);
  }
  if (view.transfer) json["transfer"] = to_toml(*view.transfer);
  json["size"] = view.size;
  json["deformed"] = view.deformed;
  json["lattice"] = view.lattice;
  json.update(settings_of(view));
  for (const Light& light : view.lighting.lights) json["light"].push_back(to_value(light));
  for (const MeshChoice& mesh : view.meshes) json["mesh"].push_back(to_value(mesh));
  for (const OffsetFunction& function : view.path) json["path"].push_back(function.given);
  for (const ClipChoice& clip : view.clips) json["clip"].push_back(to_value(clip));
  const auto name_of = [](Projection projection) {
    return projection == Projection::perspective ? "perspective" : "orthographic";
  };
  if (const auto& camera = view.camera.camera) {
    json["camera"] = {
        {"projection", name_of(camera->projection)}, {"position", camera->position_lps_mm},
        {"target", camera->target_lps_mm},           {"up", camera->up_lps},
        {"fov", camera->vertical_fov_degrees},       {"height", camera->height_mm}};
  } else {
    json["camera"] = {{"projection", name_of(view.camera.projection)}, {"view", view.camera.view}};
    if (view.camera.fov_degrees) json["camera"]["fov"] = *view.camera.fov_degrees;
    if (view.camera.height_mm) json["camera"]["height"] = *view.camera.height_mm;
  }
  json.update(more);
  return json_text(json);
}

}  // namespace supple::tools
