#include "tools/console/body_options.h"

#include <map>

#include "tools/console/parse.h"
#include "volumes/base/value.h"
#include "volumes/io/point_file.h"

namespace supple::tools {

namespace {

void set_anchors(const BodyOptions& options, SceneOptions& scene) {
  std::map<std::string, Value> lists;
  for (const std::string& text : options.fixes) {
    if (const auto label = parse_label("--fix", text)) {
      lists["fix_label"].push_back(*label);
      continue;
    }
    if (is_point_file_name(text)) {
      lists["fix_points"].push_back(text);
      continue;
    }
    const GrabText grab = parse_grab("--fix", text);
    if (grab.is_plain_box) {
      lists["fix"].push_back(grab.keys["grab_box"]);
    } else {
      lists["anchors"].push_back(grab.keys);
    }
  }
  for (const auto& [key, list] : lists) scene.set("step", key, list, "--fix");
}

/// Sets the keys for the parts that --remove, --rigid and --rigid-seed choose.
void set_parts(const BodyOptions& options, SceneOptions& scene) {
  const auto set = [&](const char* key, const char* option, const std::vector<std::string>& texts,
                       const auto& value_of) {
    Value list;
    for (const std::string& text : texts) list.push_back(value_of(option, text));
    if (!texts.empty()) scene.set("step", key, list, option);
  };
  const auto part = [](const char* option, const std::string& text) {
    return parse_grab(option, text).keys;
  };
  const auto voxel = [](const char* option, const std::string& text) {
    return numbers_value(option, text);
  };
  set("remove", "--remove", options.removed, part);
  set("rigid", "--rigid", options.rigid, part);
  set("rigid_seeds", "--rigid-seed", options.rigid_seeds, voxel);
}

/// "MESH", "label:N", or the table as in a scene.
Value cut_table(const std::string& text) {
  if (is_table(text)) return table_value("--cut", text);
  if (const auto label = parse_label("--cut", text)) return {{"label", *label}};
  return {{"mesh", text}};
}

Value cut_tables(const std::vector<std::string>& cuts) {
  Value tables = Value::List();
  for (const std::string& text : cuts) tables.push_back(cut_table(text));
  return tables;
}

}  // namespace

void add_body_options(CLI::App& app, BodyOptions& options) {
  app.add_option("input", options.input, "A volume file, or a state to continue")
      ->required()
      ->option_text("VOLUME|STATE.vdb");
  app.add_option("--material", options.material,
                 "Look-up table of link limits, or a preset such as ct-head")
      ->option_text("M.toml|NAME");
  app.add_option("--labels", options.labels,
                 "Label volume for [label.N] of the material and label:N below")
      ->option_text("FILE");
  app.add_option("--fix", options.fixes, "What stays where it is, as --grab of deform names it")
      ->allow_extra_args(false)
      ->option_text("I,J,K[:I,J,K]|…");
  app.add_option(
         "--cut", options.cuts,
         "Cut the body at rest along a surface in LPS mm (.stl, .ply, .obj), around a label, "
         "or as in scenes: {plane = {…}}; repeatable")
      ->allow_extra_args(false)
      ->option_text("MESH|label:N|TABLE");
  app.add_option("--remove", options.removed, "What is gone from now on, as for --fix")
      ->allow_extra_args(false)
      ->option_text("rigid:PLACE|…");
  app.add_option("--rigid", options.rigid, "What moves as a rigid piece, as for --fix")
      ->allow_extra_args(false)
      ->option_text("label:N|…");
  app.add_option("--rigid-seed", options.rigid_seeds, "Part a piece between such voxels")
      ->allow_extra_args(false)
      ->option_text("I,J,K");
}

void set_body(const BodyOptions& options, SceneOptions& scene) {
  scene.set("volume", "path", options.input, "input");
  if (!options.labels.empty()) {
    scene.set("labels", "path", options.labels, "--labels");
  }
  if (!options.material.empty()) {
    const bool is_preset = is_tissue_preset("--material", options.material);
    scene.set("material", is_preset ? "preset" : "table", options.material, "--material");
  }
  set_anchors(options, scene);
  set_parts(options, scene);
  if (!options.cuts.empty()) scene.set("step", "cut", cut_tables(options.cuts), "--cut");
}

}  // namespace supple::tools
