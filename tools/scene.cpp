#include "tools/scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

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
  table.know({"grab", "at_mm", "by", "by_mm_lps"});
  handle.place = table.place("grab");
  const auto grab = table.voxel("grab");
  const auto at_mm = table.vector("at_mm");
  const auto by = table.vector("by");
  const auto by_lps = table.vector("by_mm_lps");
  if (grab.has_value() == at_mm.has_value()) {
    if (!grab) table.fail_missing("grab", "either grab = [i, j, k] or at_mm");
    table.fail("grab", "grab and at_mm", "either grab = [i, j, k] or at_mm");
  }
  if (by.has_value() == by_lps.has_value()) {
    if (!by) table.fail_missing("by", "either by = [x, y, z] or by_mm_lps");
    table.fail("by", "by and by_mm_lps", "either by = [x, y, z] or by_mm_lps");
  }
  handle.in_mm = at_mm.has_value();
  if (grab) handle.voxel = *grab;
  if (at_mm) handle.at_lps_mm = *at_mm;
  handle.by_is_lps = by_lps.has_value();
  handle.by_mm = by ? *by : *by_lps;
  return handle;
}

/// True for what an int holds exactly.
bool is_integer(double value) {
  return std::abs(value) <= 2147483647.0 && value == std::floor(value);
}

IndexBox to_box(TomlTable& table, const std::vector<double>& row) {
  IndexBox box;
  const std::size_t last = row.size() - 3;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double value : {row[axis], row[last + axis]}) {
      if (!is_integer(value)) table.fail("fix", number_text(value), "integer voxels");
    }
    box.lo[axis] = int(std::min(row[axis], row[last + axis]));
    box.hi[axis] = int(std::max(row[axis], row[last + axis]));
  }
  return box;
}

CutSurface read_plane(TomlTable& table) {
  CutSurface surface;
  surface.place = table.place();
  table.know({"corner", "edge1", "edge2", "frame"});
  surface.corner = table.require(table.vector("corner"), "corner", "a point [x, y, z]");
  surface.edge1 = table.require(table.vector("edge1"), "edge1", "a vector [x, y, z]");
  surface.edge2 = table.require(table.vector("edge2"), "edge2", "a vector [x, y, z]");
  if (surface.edge1.cross(surface.edge2) == Vec3d(0)) {
    table.fail("edge2", "edges that span no area", "two vectors that differ in direction");
  }
  const std::string frame = table.string("frame").value_or("lps");
  if (frame != "lps" && frame != "voxel") {
    table.fail("frame", "\"" + frame + "\"", "\"lps\" (mm) or \"voxel\"");
  }
  surface.in_voxels = frame == "voxel";
  table.finish();
  return surface;
}

CutSurface read_cut(TomlTable& table, const std::string& scene_file) {
  table.know({"plane", "mesh"});
  auto plane = table.table("plane");
  const auto mesh = table.string("mesh");
  table.finish();
  if (plane.has_value() == mesh.has_value()) {
    if (!mesh) table.fail_missing("mesh", "either mesh or plane");
    table.fail("mesh", "mesh and plane", "either mesh or plane");
  }
  return plane ? read_plane(*plane) : mesh_cut(beside(scene_file, *mesh));
}

SceneStep read_step(TomlTable& table, const std::string& scene_file) {
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
  for (TomlTable& cut : table.tables("cut")) step.cuts.push_back(read_cut(cut, scene_file));
  table.finish();
  if (is_short) step.handles.push_back(read_handle(table));
  if (step.handles.empty() && step.fix.empty() && !step.release && step.cuts.empty()) {
    table.fail("", "a step that does nothing", "grab, handles, fix, cut or release");
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
  table.know({"projection", "view", "position", "target", "up", "fov", "height"});
  choice.projection = read_projection(table);
  choice.view = table.string("view").value_or(choice.view);
  const std::vector<std::string> views = view_names();
  if (std::find(views.begin(), views.end(), choice.view) == views.end()) {
    std::string expected = "one of";
    for (const std::string& name : views) expected += " " + name;
    table.fail("view", "\"" + choice.view + "\"", expected);
  }
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
  const bool perspective = choice.projection == Projection::perspective;
  if (perspective && height) table.fail("height", "height", "fov for a perspective camera");
  if (!perspective && fov) table.fail("fov", "fov", "height for an orthographic camera");
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
  table.know({"image", "preset", "camera", "size", "step", "deformed", "lattice", "after_step"});
  view.image = table.require(table.string("image"), "image", "the name of a PNG file");
  view.preset = table.string("preset").value_or(view.preset);
  if (auto camera = table.table("camera")) view.camera = read_camera_table(*camera);
  if (const auto size = table.numbers("size")) {
    if (size->size() != 2 || !is_integer((*size)[0]) || !is_integer((*size)[1])) {
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

  root.know({"volume", "material", "step", "view", "output"});
  TomlTable volume = root.require(root.table("volume"), "volume", "a table [volume] with a path");
  volume.know({"path", "raw"});
  scene.volume_path =
      beside(path, volume.require(volume.string("path"), "path", "the path of a volume"));
  scene.raw_spec = volume.string("raw").value_or("");
  volume.finish();

  if (auto material = root.table("material")) {
    if (const auto file = material->string("table")) {
      material->finish();
      scene.material_path = beside(path, *file);
      scene.material = read_material(scene.material_path);
    } else {
      scene.material = read_material_table(*material);
    }
  }
  for (TomlTable& step : root.tables("step")) {
    scene.steps.push_back(read_step(step, path));
  }
  const int steps = int(scene.steps.size());
  for (TomlTable& view : root.tables("view")) scene.views.push_back(read_view(view, steps));
  if (auto output = root.table("output")) scene.output = read_output(*output);
  root.finish();
  return scene;
}

CameraChoice read_camera(const std::string& path) {
  const toml::table root = read_toml_file(path);
  TomlTable table(root, path, "");
  return read_camera_table(table);
}

}  // namespace supple::tools
