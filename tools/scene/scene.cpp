#include "tools/scene/scene.h"

#include <algorithm>

#include "lib/material/material_file.h"
#include "lib/material/toml_table.h"
#include "tools/scene/cut_keys.h"
#include "tools/scene/handle_keys.h"
#include "tools/scene/spring_keys.h"
#include "volumes/base/error.h"
#include "volumes/io/load/label_file.h"
#include "volumes/io/open_volume.h"

namespace supple::tools {

namespace {

RelaxParams read_relax(TomlTable& table) {
  RelaxParams params;
  table.read(fields(params));
  if (params.bulk_modulus_kpa > 0 && !conserves_volume(params.method)) {
    table.fail("bulk_modulus", std::string("method \"") + name_of(params.method) + "\"",
               "method \"red-black\" or \"accelerated\"");
  }
  table.finish();
  return params;
}

/// What moves the body, unless it is ECM. Without a table of springs their defaults.
std::optional<SpringStep> read_springs(TomlTable& table, bool has_springs) {
  auto springs = table.table("springs");
  if (!has_springs) {
    if (springs) {
      const std::vector<std::string> keys = springs->keys();
      springs->fail(keys.empty() ? "" : keys.front(), "springs without their model",
                    "model = \"springs\"");
    }
    return std::nullopt;
  }
  for (const char* key : {"relax", "limits"}) {
    if (table.has(key)) {
      table.fail(key, std::string(key) + " beside springs", "a step of its own for it");
    }
  }
  return springs ? read_spring_step(*springs) : SpringStep();
}

SceneStep read_step(TomlTable& table, const LabelNames& names) {
  SceneStep step;
  step.place = table.place();
  for (TomlTable& handle : table.tables("handles")) {
    step.handles.push_back(read_handle(handle, names));
    handle.finish();
  }
  const bool is_short = has_handle(table);
  if (is_short && !step.handles.empty()) {
    table.fail("grab", "grab beside handles", "either the short form or handles");
  }
  const auto rows = table.rows("fix", {3, 6}, "a list of [i, j, k] or [i0, j0, k0, i1, j1, k1]");
  if (rows) {
    for (const auto& row : *rows) step.fix.push_back(to_box(table, "fix", row));
  }
  for (const std::string& path : table.paths("fix_points")) {
    step.fix_points.push_back(read_point_file(path));
  }
  for (TomlTable& anchor : table.table_or_tables("anchors")) {
    step.anchors.push_back(read_anchor(anchor, names));
    anchor.finish();
  }
  step.fix_labels = read_labels(table, "fix_label", names);
  StepSettings settings;
  table.read(fields(settings));
  if (settings.fix_density) {
    GivenSelection& bone = step.anchors.emplace_back();
    bone.place = table.place("fix_density");
    bone.density = settings.fix_density;
  }
  step.release = settings.release;
  step.limits = settings.limits;
  step.springs = read_springs(table, settings.has_springs);
  for (TomlTable& cut : table.tables("cut")) step.cuts.push_back(read_cut(cut, names));
  if (auto relax = table.table("relax")) step.relax = read_relax(*relax);
  table.finish();
  if (is_short) step.handles.push_back(read_handle(table, names));
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
         anchors.empty() && cuts.empty() && !relax && !springs && limits != Limits::tighten;
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

Fields fields(StepSettings& settings) {
  return {
      Field("model", settings.has_springs, {"ecm", "springs"},
            "What moves the body: Enhanced ChainMail, or springs (docs/models/springs.md)"),
      Field("limits", settings.limits, {"box", "ball", "tighten"},
            "box: each component of a link; ball: its length, order-dependent; tighten: box, and "
            "narrower across stretched links"),
      Field("fix_density", settings.fix_density, "Elements of these densities stay where they are"),
      Field("release", settings.release, "Let go of everything that is held or fixed"),
  };
}

Scene read_scene(const std::string& path) {
  return read_scene(TomlTable::read(path));
}

Scene read_scene(TomlTable root) {
  Scene scene;
  scene.file = root.file();

  root.know({"volume", "labels", "material", "step", "view", "path", "output"});
  TomlTable volume = root.require(root.table("volume"), "volume", "a table [volume] with a path");
  volume.know({"path", "offsets"});
  volume.read(fields(scene.read));
  scene.volume_path = volume.require(volume.path("path"), "path", "the path of a volume");
  scene.warp_path = volume.path("offsets").value_or("");
  volume.finish();

  LabelNames names;
  if (auto labels = root.table("labels")) {
    scene.labels_path = labels->require(labels->path("path"), "path", "the path of a volume");
    labels->finish();
    names = label_names(scene.labels_path);
  }
  if (auto material = root.table("material")) {
    if (const auto file = material->path("table")) {
      material->finish();
      scene.material_path = *file;
      scene.material = read_material(scene.material_path, names);
    } else {
      scene.material = read_material_table(*material, names);
    }
  }
  for (TomlTable& step : root.tables("step")) {
    scene.steps.push_back(read_step(step, names));
  }
  const int steps = int(scene.steps.size());
  for (TomlTable& view : root.tables("view")) scene.views.push_back(read_view(view, steps));
  scene.path = read_path(root);
  if (auto output = root.table("output")) scene.output = read_output(*output);
  root.finish();
  scene.warnings = root.warnings();
  return scene;
}

}  // namespace supple::tools
