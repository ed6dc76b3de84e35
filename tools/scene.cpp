#include "tools/scene.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "tools/material_file.h"
#include "tools/toml_table.h"
#include "volumes/base/error.h"

namespace supple::tools {

namespace {

/// Relative paths of inputs start at the folder of the scene file.
std::string beside(const std::string& scene_file, const std::string& path) {
  const std::filesystem::path input(path);
  if (input.is_absolute()) return path;
  return (std::filesystem::path(scene_file).parent_path() / input).string();
}

SceneHandle read_handle(TomlTable& table) {
  SceneHandle handle;
  handle.place = table.place("grab");
  const auto grab = table.voxel("grab");
  const auto at_mm = table.vector("at_mm");
  const auto by = table.vector("by");
  const auto by_lps = table.vector("by_mm_lps");
  if (grab.has_value() == at_mm.has_value()) {
    table.fail("grab", grab ? "grab and at_mm" : "nothing", "either grab = [i, j, k] or at_mm");
  }
  if (by.has_value() == by_lps.has_value()) {
    table.fail("by", by ? "by and by_mm_lps" : "nothing", "either by = [x, y, z] or by_mm_lps");
  }
  handle.in_mm = at_mm.has_value();
  if (grab) handle.voxel = *grab;
  if (at_mm) handle.at_lps_mm = *at_mm;
  handle.by_is_lps = by_lps.has_value();
  handle.by_mm = by ? *by : *by_lps;
  return handle;
}

IndexBox to_box(TomlTable& table, const std::vector<double>& row) {
  IndexBox box;
  const std::size_t last = row.size() - 3;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double value : {row[axis], row[last + axis]}) {
      if (value != int(value)) table.fail("fix", std::to_string(value), "integer voxels");
    }
    box.lo[axis] = int(std::min(row[axis], row[last + axis]));
    box.hi[axis] = int(std::max(row[axis], row[last + axis]));
  }
  return box;
}

SceneStep read_step(TomlTable& table) {
  SceneStep step;
  step.place = table.place();
  for (TomlTable& handle : table.tables("handles")) {
    step.handles.push_back(read_handle(handle));
    handle.finish();
  }
  // The short form of one handle.
  bool is_short = false;
  for (const char* key : {"grab", "at_mm", "by", "by_mm_lps"}) {
    is_short = table.has(key) || is_short;
  }
  if (is_short && !step.handles.empty()) {
    table.fail("grab", "grab beside handles", "either the short form or handles");
  }
  const auto rows = table.rows("fix", {3, 6}, "a list of [i, j, k] or [i0, j0, k0, i1, j1, k1]");
  if (rows) {
    for (const auto& row : *rows) step.fix.push_back(to_box(table, row));
  }
  step.release = table.boolean("release").value_or(false);
  table.finish();
  if (is_short) step.handles.push_back(read_handle(table));
  if (step.handles.empty() && step.fix.empty() && !step.release) {
    table.fail("", "a step that does nothing", "grab, handles, fix or release");
  }
  return step;
}

Projection read_projection(TomlTable& table) {
  const std::string name = table.string("projection").value_or("perspective");
  if (name == "perspective") return Projection::perspective;
  if (name == "orthographic") return Projection::orthographic;
  table.fail("projection", "\"" + name + "\"", "\"perspective\" or \"orthographic\"");
}

CameraChoice read_camera_table(TomlTable& table) {
  CameraChoice choice;
  choice.projection = read_projection(table);
  choice.view = table.string("view").value_or(choice.view);
  const auto position = table.vector("position");
  const auto target = table.vector("target");
  const auto up = table.vector("up");
  const auto fov = table.number("fov");
  const auto height = table.number("height");
  table.finish();
  if (!position && !target && !up && !fov && !height) return choice;
  if (table.has("view")) {
    table.fail("view", "view beside position", "a named view or a position, not both");
  }
  Camera camera;
  camera.projection = choice.projection;
  camera.position_lps_mm = table.require(position, "position", "three numbers in LPS mm");
  camera.target_lps_mm = table.require(target, "target", "three numbers in LPS mm");
  camera.up_lps = up.value_or(camera.up_lps);
  camera.vertical_fov_degrees = fov.value_or(camera.vertical_fov_degrees);
  camera.height_mm = height.value_or(camera.height_mm);
  camera.validate(table.place());
  choice.camera = camera;
  return choice;
}

SceneView read_view(TomlTable& table, int steps) {
  SceneView view;
  view.place = table.place();
  view.image = table.require(table.string("image"), "image", "the name of a PNG file");
  view.preset = table.string("preset").value_or(view.preset);
  if (auto camera = table.table("camera")) view.camera = read_camera_table(*camera);
  if (const auto size = table.numbers("size")) {
    if (size->size() != 2 || (*size)[0] != int((*size)[0]) || (*size)[1] != int((*size)[1])) {
      table.fail("size", "another list", "two integers [width, height]");
    }
    view.width = int((*size)[0]);
    view.height = int((*size)[1]);
  }
  view.step_voxels = table.number("step").value_or(view.step_voxels);
  view.deformed = table.boolean("deformed").value_or(true);
  view.lattice = table.boolean("lattice").value_or(false);
  if (const auto after = table.integer("after_step")) {
    if (*after < 0 || *after > steps) {
      table.fail("after_step", std::to_string(*after), "0 to " + std::to_string(steps));
    }
    view.after_step = int(*after);
  }
  table.finish();
  return view;
}

SceneOutput read_output(TomlTable& table) {
  SceneOutput output;
  output.state = table.string("state").value_or("");
  output.offsets = table.strings("offsets").value_or(std::vector<std::string>{});
  output.displacements = table.strings("displacements").value_or(std::vector<std::string>{});
  output.volumes = table.strings("volumes").value_or(std::vector<std::string>{});
  table.finish();
  return output;
}

void check_unique_outputs(const Scene& scene) {
  std::set<std::string> seen;
  for (const std::string& path : scene.outputs()) {
    if (path.empty()) throw InputError({scene.file, "output", "an empty name", "a file name"});
    if (!seen.insert(path).second) {
      throw InputError({scene.file, "output", "'" + path + "' twice", "different file names"});
    }
  }
}

}  // namespace

std::vector<std::string> Scene::outputs() const {
  std::vector<std::string> paths;
  for (const SceneView& view : views) paths.push_back(view.image);
  if (!output.state.empty()) paths.push_back(output.state);
  for (const auto* list : {&output.offsets, &output.displacements, &output.volumes}) {
    paths.insert(paths.end(), list->begin(), list->end());
  }
  return paths;
}

Scene read_scene(const std::string& path) {
  const toml::table root_table = read_toml_file(path);
  TomlTable root(root_table, path, "");
  Scene scene;
  scene.file = path;

  TomlTable volume = root.require(root.table("volume"), "volume", "a table [volume] with a path");
  scene.volume_path =
      beside(path, volume.require(volume.string("path"), "path", "the path of a volume"));
  scene.raw_spec = volume.string("raw").value_or("");
  volume.finish();

  if (auto material = root.table("material")) {
    if (const auto file = material->string("table")) {
      material->finish();
      scene.material = read_material(beside(path, *file));
    } else {
      scene.material = read_material_table(*material);
    }
  }
  for (TomlTable& step : root.tables("step")) scene.steps.push_back(read_step(step));
  const int steps = int(scene.steps.size());
  for (TomlTable& view : root.tables("view")) scene.views.push_back(read_view(view, steps));
  if (auto output = root.table("output")) scene.output = read_output(*output);
  root.finish();
  check_unique_outputs(scene);
  return scene;
}

CameraChoice read_camera(const std::string& path) {
  const toml::table root = read_toml_file(path);
  TomlTable table(root, path, "");
  return read_camera_table(table);
}

}  // namespace supple::tools
