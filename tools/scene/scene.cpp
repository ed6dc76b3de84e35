#include "tools/scene/scene.h"

#include <algorithm>

#include "lib/material/material_file.h"
#include "lib/material/toml_table.h"
#include "tools/scene/spring_keys.h"
#include "volumes/base/error.h"

namespace supple::tools {

namespace {

IndexBox to_box(TomlTable& table, const std::string& key, const std::vector<double>& row) {
  IndexBox box;
  const std::size_t last = row.size() - 3;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double value : {row[axis], row[last + axis]}) {
      if (!is_integer(value)) table.fail(key, number_text(value), "integer voxels");
    }
    box.lo[axis] = int(std::min(row[axis], row[last + axis]));
    box.hi[axis] = int(std::max(row[axis], row[last + axis]));
  }
  return box;
}

/// What a handle may have, in `handles` and in a step's short form.
constexpr std::initializer_list<const char*> kHandleKeys = {
    "grab", "grab_box", "grab_label", "at_mm", "points", "by", "by_mm_lps", "push"};

std::optional<PointFile> read_points(TomlTable& table, const std::string& key) {
  const auto path = table.path(key);
  if (!path) return std::nullopt;
  return read_point_file(*path);
}

std::int32_t to_label(TomlTable& table, const std::string& key, double value) {
  const bool is_label = is_integer(value) && value >= 1 && value <= kMaxLabel;
  if (!is_label) {
    table.fail(key, number_text(value), "labels from 1 to " + std::to_string(kMaxLabel));
  }
  return std::int32_t(value);
}

std::int32_t read_label(TomlTable& table, const std::string& key) {
  const auto value = table.number(key);
  return to_label(table, key, table.require(value, key, "a label"));
}

/// Which elements, by exactly one of the keys.
void read_grab(TomlTable& table, GivenHandle& handle) {
  if (const auto voxel = table.voxel("grab")) handle.box = IndexBox{*voxel, *voxel};
  if (const auto corners = table.numbers("grab_box")) {
    if (handle.box) table.fail("grab_box", "grab and grab_box", "one of both");
    if (corners->size() != 6) {
      table.fail("grab_box", std::to_string(corners->size()) + " numbers",
                 "six integers [i0, j0, k0, i1, j1, k1]");
    }
    handle.box = to_box(table, "grab_box", *corners);
  }
  handle.at_lps_mm = table.vector("at_mm");
  handle.points = read_points(table, "points");
  if (table.has("grab_label")) handle.label = read_label(table, "grab_label");
  const int given = int(handle.box.has_value()) + int(handle.at_lps_mm.has_value()) +
                    int(handle.points.has_value()) + int(handle.label.has_value());
  const char* expected = "one of grab = [i, j, k], grab_box, grab_label, at_mm and points";
  if (given == 0) table.fail_missing("grab", expected);
  if (given > 1) table.fail("grab", "several of them", expected);
}

GivenHandle read_handle(TomlTable& table) {
  GivenHandle handle;
  table.know(kHandleKeys);
  handle.place = table.place("grab");
  read_grab(table, handle);
  handle.by_mm = table.vector("by");
  handle.by_lps_mm = table.vector("by_mm_lps");
  handle.push = table.boolean("push").value_or(false);
  if (handle.points && handle.points->has_displacements) {
    if (!handle.by_mm && !handle.by_lps_mm) return handle;
    table.fail(handle.by_mm ? "by" : "by_mm_lps", "a displacement beside those of the points",
               "one of both");
  }
  if (handle.by_mm.has_value() == handle.by_lps_mm.has_value()) {
    if (!handle.by_mm) table.fail_missing("by", "either by = [x, y, z] or by_mm_lps");
    table.fail("by", "by and by_mm_lps", "either by = [x, y, z] or by_mm_lps");
  }
  return handle;
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

CutSurface read_cut(TomlTable& table) {
  table.know({"plane", "mesh", "label"});
  auto plane = table.table("plane");
  const auto mesh = table.path("mesh");
  const bool has_label = table.has("label");
  table.finish();
  const int given = int(plane.has_value()) + int(mesh.has_value()) + int(has_label);
  if (given == 0) table.fail_missing("mesh", "either mesh, plane or label");
  if (given > 1) table.fail("mesh", "several of them", "either mesh, plane or label");
  if (has_label) return label_cut(read_label(table, "label"), table.place());
  return plane ? read_plane(*plane) : mesh_cut(*mesh);
}

Limits read_limits(TomlTable& table) {
  const std::string name = table.string("limits").value_or("box");
  const auto limits = limits_of_name(name);
  if (!limits) table.fail("limits", "\"" + name + "\"", "\"box\", \"ball\" or \"tighten\"");
  return *limits;
}

RelaxParams read_relax(TomlTable& table) {
  RelaxParams params;
  table.know({"passes", "tolerance", "method", "volume"});
  if (const auto passes = table.integer("passes")) {
    if (*passes < 1 || *passes > kMaxPasses) {
      table.fail("passes", std::to_string(*passes), "1 to " + std::to_string(kMaxPasses));
    }
    params.passes = int(*passes);
  }
  if (const auto tolerance = table.number("tolerance")) {
    if (!(*tolerance >= 0)) table.fail("tolerance", number_text(*tolerance), "0 or more voxels");
    params.tolerance_voxels = *tolerance;
  }
  if (const auto name = table.string("method")) {
    const auto method = relax_method(*name);
    if (!method) table.fail("method", "\"" + *name + "\"", relax_method_names());
    params.method = *method;
  }
  if (const auto volume = table.number("volume")) {
    if (!(*volume >= 0 && *volume <= kMaxBulkModulusKpa)) {
      table.fail("volume", number_text(*volume),
                 "0 to " + number_text(kMaxBulkModulusKpa) + " kPa");
    }
    if (*volume > 0 && !conserves_volume(params.method)) {
      table.fail("volume", std::string("method \"") + name_of(params.method) + "\"",
                 "method \"red-black\" or \"accelerated\"");
    }
    params.bulk_modulus_kpa = *volume;
  }
  table.finish();
  return params;
}

/// The step's model: without a table of springs their defaults.
std::optional<SpringStep> read_model(TomlTable& table) {
  const std::string name = table.string("model").value_or("ecm");
  if (name != "ecm" && name != "springs") {
    table.fail("model", "\"" + name + "\"", "\"ecm\" or \"springs\"");
  }
  auto springs = table.table("springs");
  if (name == "ecm") {
    if (springs) table.fail("springs", "springs without their model", "model = \"springs\"");
    return std::nullopt;
  }
  for (const char* key : {"relax", "limits"}) {
    if (table.has(key)) {
      table.fail(key, std::string(key) + " beside springs", "a step of its own for it");
    }
  }
  return springs ? read_spring_step(*springs) : SpringStep();
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
  for (const char* key : kHandleKeys) {
    is_short = table.has(key) || is_short;
  }
  if (is_short && !step.handles.empty()) {
    table.fail("grab", "grab beside handles", "either the short form or handles");
  }
  const auto rows = table.rows("fix", {3, 6}, "a list of [i, j, k] or [i0, j0, k0, i1, j1, k1]");
  if (rows) {
    for (const auto& row : *rows) step.fix.push_back(to_box(table, "fix", row));
  }
  if (auto points = read_points(table, "fix_points")) {
    step.fix_points.push_back(std::move(*points));
  }
  if (const auto labels = table.numbers("fix_label")) {
    for (const double label : *labels) {
      step.fix_labels.push_back(to_label(table, "fix_label", label));
    }
  }
  step.release = table.boolean("release").value_or(false);
  step.springs = read_model(table);
  step.limits = read_limits(table);
  for (TomlTable& cut : table.tables("cut")) step.cuts.push_back(read_cut(cut));
  if (auto relax = table.table("relax")) step.relax = read_relax(*relax);
  table.finish();
  if (is_short) step.handles.push_back(read_handle(table));
  if (step.does_nothing()) {
    table.fail("", "a step that does nothing",
               "grab, handles, fix, fix_label, fix_points, cut, relax, model, release or limits");
  }
  return step;
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

bool SceneStep::does_nothing() const {
  return handles.empty() && fix.empty() && fix_points.empty() && !release && fix_labels.empty() &&
         cuts.empty() && !relax && !springs && limits != Limits::tighten;
}

std::vector<std::string> Scene::outputs() const {
  std::vector<std::string> paths;
  for (const SceneView& view : views) {
    const std::vector<std::string> files = picture_files(view.picture, view.image);
    paths.insert(paths.end(), files.begin(), files.end());
  }
  if (!output.state.empty()) paths.push_back(output.state);
  for (const auto* list : {&output.offsets, &output.displacements, &output.volumes}) {
    paths.insert(paths.end(), list->begin(), list->end());
  }
  return paths;
}

namespace {

ReadOptions read_options(TomlTable& volume) {
  ReadOptions options;
  options.raw = volume.string("raw").value_or("");
  for (const auto& [key, choice] :
       {std::pair{"frame", &options.frame}, std::pair{"channel", &options.channel}}) {
    const auto value = volume.integer(key);
    if (!value) continue;
    if (*value < 0 || *value > std::numeric_limits<int>::max()) {
      volume.fail(key, std::to_string(*value), "an index from 0");
    }
    *choice = int(*value);
  }
  options.spacing_mm = volume.vector("spacing");
  return options;
}

}  // namespace

Scene read_scene(const std::string& path) {
  TomlTable root = TomlTable::read(path);
  Scene scene;
  scene.file = path;

  root.know({"volume", "labels", "material", "step", "view", "offset", "output"});
  TomlTable volume = root.require(root.table("volume"), "volume", "a table [volume] with a path");
  volume.know({"path", "raw", "frame", "channel", "spacing"});
  scene.volume_path = volume.require(volume.path("path"), "path", "the path of a volume");
  scene.read = read_options(volume);
  volume.finish();

  if (auto labels = root.table("labels")) {
    scene.labels_path = labels->require(labels->path("path"), "path", "the path of a volume");
    labels->finish();
  }
  if (auto material = root.table("material")) {
    if (const auto file = material->path("table")) {
      material->finish();
      scene.material_path = *file;
      scene.material = read_material(scene.material_path);
    } else {
      scene.material = read_material_table(*material);
    }
  }
  for (TomlTable& step : root.tables("step")) {
    scene.steps.push_back(read_step(step));
  }
  const int steps = int(scene.steps.size());
  for (TomlTable& view : root.tables("view")) scene.views.push_back(read_view(view, steps));
  scene.offset = read_offset_functions(root);
  if (auto output = root.table("output")) scene.output = read_output(*output);
  root.finish();
  return scene;
}

}  // namespace supple::tools
